#include "identify/problem/block_columns.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace wems::identify {
namespace {

constexpr double kUnfold = 1.4142135623730951;  // real and imaginary parts share the variance
constexpr Eigen::Index kChunk = 1024;

}  // namespace

Eigen::VectorXf unfold(const Eigen::Ref<const Eigen::MatrixXcd>& rows) {
    Eigen::VectorXf values(2 * rows.size());
    Eigen::Map<Eigen::MatrixXf> real(values.data(), rows.rows(), rows.cols());
    Eigen::Map<Eigen::MatrixXf> imaginary(values.data() + rows.size(), rows.rows(), rows.cols());
    real = (kUnfold * rows.real()).cast<float>();
    imaginary = (kUnfold * rows.imag()).cast<float>();
    return values;
}

BlockInformation BlockColumns::calcInformation(const Eigen::VectorXf& residual) const {
    std::vector<Eigen::Index> used;
    for (std::size_t c = 0; c < columns_.size(); ++c)
        if (columns_[c].size() > 0) used.push_back(c);
    const Eigen::Index count = used.size(), all = columns_.size();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
    BlockInformation result;
    for (Eigen::Index first = 0; first < rows_; first += kChunk) {
        const Eigen::Index rows = std::min(kChunk, rows_ - first);
        Eigen::MatrixXd chunk(rows, count);
        for (Eigen::Index i = 0; i < count; ++i) chunk.col(i) = columns_[used[i]].segment(first, rows).cast<double>();
        const Eigen::VectorXd r = residual.segment(first, rows).cast<double>();
        A.selfadjointView<Eigen::Lower>().rankUpdate(chunk.transpose());
        b.noalias() += chunk.transpose() * r;
        result.chi_squared += r.squaredNorm();
    }
    A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
    result.A = Eigen::MatrixXd::Zero(all, all);
    result.b = Eigen::VectorXd::Zero(all);
    result.noise_slopes = Eigen::MatrixXd::Zero(all, 0);
    result.A(used, used) = A;
    result.b(used) = b;
    result.count = static_cast<double>(rows_);
    return result;
}

Eigen::VectorXd BlockColumns::project(const Eigen::VectorXf& residual) const {
    Eigen::VectorXd b = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns_.size()));
    const Eigen::VectorXd r = residual.cast<double>();
    for (std::size_t c = 0; c < columns_.size(); ++c)
        if (columns_[c].size() > 0) b[static_cast<Eigen::Index>(c)] = columns_[c].cast<double>().dot(r);
    return b;
}

Eigen::MatrixXd marginalise(BlockInformation& block, Eigen::Index count, double precision) {
    const Eigen::Index kept = block.b.size() - count;
    if (count == 0) return {};
    Eigen::MatrixXd own = block.A.bottomRightCorner(count, count);
    own.diagonal().array() += precision;
    const Eigen::LDLT<Eigen::MatrixXd> factor(own);
    const Eigen::MatrixXd cross = block.A.topRightCorner(kept, count);
    const Eigen::VectorXd right = block.b.tail(count);
    block.chi_squared -= right.dot(factor.solve(right));
    if (kept == 0) {
        block.A.resize(0, 0);
        block.b.resize(0);
        return {};
    }
    const Eigen::MatrixXd taken_out = factor.solve(cross.transpose()).transpose();
    const Eigen::VectorXd b = block.b.head(kept) - taken_out * right;
    const Eigen::MatrixXd A = block.A.topLeftCorner(kept, kept) - cross * taken_out.transpose();
    block.A = A;
    block.b = b;
    return taken_out;
}

}  // namespace wems::identify
