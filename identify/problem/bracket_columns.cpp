// Lineariser: what modes make of the bracket's equation.
#include <Eigen/Dense>
#include <cmath>

#include "identify/problem/lineariser.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;
using Vector6c = Eigen::Matrix<Complex, 6, 1>;

}  // namespace

Lineariser::Modal Lineariser::makeModal(const BracketMode& mode) const {
    const Eigen::Index bins = spectra_.binCount();
    const Eigen::RowVectorXcd force = calcParticipation(mode).transpose().cast<Complex>() * input_spectra_;
    Modal modal{force, respond(force, [&](double w) { return calcModalResponse(mode, w); }), Eigen::MatrixXcd(6, bins)};
    const Vector6c shape = calcShape(mode).cast<Complex>();
    for (Eigen::Index b = 0; b < bins; ++b) modal.white.col(b) = noise_.whitener(b).bottomRightCorner<6, 6>() * shape;
    return modal;
}

Eigen::RowVectorXcd Lineariser::respond(const Eigen::RowVectorXcd& spectrum,
                                        const std::function<Complex(double w)>& response) const {
    return transformFixed(bracket_.respond(spectrum, response));
}

Eigen::MatrixXcd Lineariser::transformBracket(Eigen::Index first, const Eigen::MatrixXd& inputs) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(12, inputs.cols());
    all.middleRows(first, inputs.rows()) = inputs;
    return transformFixed(bracket_.calcPrediction(model_, all));
}

Eigen::MatrixXcd Lineariser::transformFixed(Eigen::MatrixXd series) const {
    series.colwise() -= series.rowwise().mean().eval();
    return spectra_.transform(series);
}

Eigen::MatrixXcd Lineariser::calcModeColumn(int mode, int which) const {
    const BracketMode& own = model_.bracket[mode];
    const Modal& modal = modal_[mode];
    const double w0 = kTwoPi * own.frequency;
    return modal.white * respond(modal.force, [&](double w) {
                             const Complex h = calcModalResponse(own, w);
                             const Complex slope = which == 0 ? Complex(2 * w0, 2 * own.damping_ratio * w) * kTwoPi
                                                              : Complex(0, 2 * w0 * w);
                             return -h * h * slope;
                         }).asDiagonal();
}

Eigen::MatrixXcd Lineariser::calcShapeColumn(int mode, int entry) const {
    const Modal& modal = modal_[mode];
    const BracketMode& own = model_.bracket[mode];
    // With a load point of the model's own the bracket's is not loaded.
    Eigen::MatrixXcd white = modal.white * respond(input_spectra_.row(entry), [&](double w) {
                                               return calcModalResponse(own, w);
                                           }).asDiagonal();
    for (Eigen::Index b = 0; entry < 6 && b < white.cols(); ++b)
        white.col(b) += modal.motion[b] * noise_.whitener(b).bottomRightCorner<6, 6>().col(entry);
    return white;
}

Eigen::MatrixXcd Lineariser::calcAddedMode(const BracketMode& mode) const {
    const Modal modal = makeModal(mode);
    return modal.white * modal.motion.asDiagonal();
}

Eigen::MatrixXcd Lineariser::calcTransient(int mode, bool sine) const {
    const BracketMode& own = model_.bracket[mode];
    const double w = kTwoPi * own.frequency;
    const Eigen::ArrayXd phase = w * open_.time.array();
    const Eigen::RowVectorXd decay =
        (-own.damping_ratio * phase).exp() * (sine ? phase.sin().eval() : phase.cos().eval());
    const Eigen::MatrixXcd spectrum = spectra_.transform(decay);
    const Vector6c shape = calcShape(own).cast<Complex>();
    Eigen::MatrixXcd white(6, spectrum.cols());
    for (Eigen::Index b = 0; b < white.cols(); ++b)
        white.col(b) = noise_.whitener(b).bottomRightCorner<6, 6>() * shape * spectrum(0, b);
    return white;
}

Eigen::MatrixXcd Lineariser::calcModalEdges(const Eigen::MatrixXd& accelerations,
                                            const Eigen::MatrixXcd& tapered) const {
    const Eigen::MatrixXcd spectra = bracket_.calcSpectra(accelerations.transpose());
    Eigen::MatrixXcd edges(6 * static_cast<Eigen::Index>(model_.bracket.size()), tapered.cols());
    Eigen::Index row = 0;
    for (const BracketMode& own : model_.bracket) {
        Eigen::RowVectorXcd response(tapered.cols());
        for (Eigen::Index b = 0; b < response.size(); ++b) response[b] = calcModalResponse(own, spectra_.angular(b));
        for (Eigen::Index m = 0; m < 6; ++m)
            edges.row(row++) = respond(spectra.row(m), [&](double w) { return calcModalResponse(own, w); }) -
                               tapered.row(m).cwiseProduct(response);
    }
    return edges;
}

Eigen::MatrixXcd Lineariser::calcBracketEdges(const SensorEffect& effect) const {
    Eigen::MatrixXcd edges = Eigen::MatrixXcd::Zero(6, spectra_.binCount());
    for (const auto& group : effect.groups) {
        if (group.signals->modal_edges.size() == 0) continue;
        const Matrix6 wrench = calcMassMatrix(model_.body) * group.turn;
        Eigen::Index row = 0;
        for (const BracketMode& own : model_.bracket) {
            const Vector6 shape = calcShape(own), weights = wrench.transpose() * shape;
            const Matrix6 all = shape * weights.transpose();
            edges.noalias() -= all.cast<Complex>() * group.signals->modal_edges.middleRows(row, 6);
            row += 6;
        }
    }
    return edges;
}

}  // namespace wems::identify
