/// @file
/// A structural mode that the modes file lacks, as a candidate: frequency, damping ratio and shape.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identify/exact/catalogue.hpp"
#include "identify/exact/open_loop_problem.hpp"

namespace wems::identify {

// Where in frequency one more mode would take away most of a residual, and with what shape.
//
// A mode that a model lacks leaves r(ω) = −h(ω) φ pᵀ u(ω), h = 1/(ω_j² − ω² + 2 i ζ ω_j ω), u the spectra of what
// drives the modes, p the mode's participation in them; the first six of u are the wrench at the interface, where the
// mode has the shape φ, so that φ is the head of p. For given ω_j and ζ, the matrix A = φ pᵀ follows from linear least
// squares; its largest singular pair starts a Gauss–Newton iteration for p. A mode cannot give energy: a matrix whose
// head has no positive part is no mode.

struct ModalGuess {
    double frequency = 0;      ///< Hz
    double damping_ratio = 0;  ///< -
    Eigen::VectorXd participation;
    double gain = 0;  ///< decrease of the whitened sum of squares
};

/// Sums over runs and narrow bands of frequency; a fit then costs the same for any length of recordings.
class ModalScan {
public:
    using Matrix6c = Eigen::Matrix<std::complex<double>, 6, 6>;
    using Vector6c = Eigen::Matrix<std::complex<double>, 6, 1>;

    /// @param inputs length of u, at least 6
    /// @param lever m, makes rotations comparable with translations
    ModalScan(double lowest, double highest, Eigen::Index inputs, double lever);

    /// One frequency (Hz) of one run: the inputs, the factor that whitens the residual, and the whitened residual.
    void add(double frequency, const Eigen::Ref<const Eigen::VectorXcd>& input, const Matrix6c& factor,
             const Vector6c& white_residual);

    /// The best mode at a given frequency and damping ratio; gain zero if there is none.
    ModalGuess fit(double frequency, double damping_ratio) const;

    /// The best few modes anywhere in the band, by falling gain, each at a maximum of its own.
    std::vector<ModalGuess> findBest(std::size_t count) const;

private:
    struct Band {
        double frequency = 0;  // sum over what was added
        int count = 0;
        Eigen::MatrixXd normal;  // of vec(A) for h = 1
        Eigen::MatrixXcd right;  // 6 x inputs, the same
    };
    ModalGuess refine(ModalGuess guess) const;

    double lowest_, highest_;
    Eigen::Index inputs_;
    double lever_;
    std::vector<Band> bands_;
};

/// One candidate with the best few starts that a scan of the bracket's residual gives; none where the bracket's
/// equation leaves no more than noise, or no mode takes anything away.
///
/// Where the load point of all the model's modes moves rigidly with the interface, that of the new one does, and its
/// shape has six unknowns; otherwise the participation in each direction of the load is one more, as is that of each
/// direction in which the base was driven. Directions in which nothing acted are not determined: the load point then
/// moves as it would were it rigid, the base does not drive the mode.
std::vector<Candidate> makeMissingMode(const OpenLoopProblem& problem, const MountModel& model,
                                       const WhiteVector& residual);

}  // namespace wems::identify
