/// @file
/// Whitened columns of one block of a run, and what they say together.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "identify/problem/information.hpp"

namespace wems::identify {

/// Real values of complex rows (rows x bins): real parts, then imaginary parts, of each bin. They share the variance.
Eigen::VectorXf unfold(const Eigen::Ref<const Eigen::MatrixXcd>& rows);

/// Those that are not set are zero.
class BlockColumns {
public:
    BlockColumns() = default;
    BlockColumns(Eigen::Index rows, Eigen::Index columns) : rows_(rows), columns_(columns) {}

    void set(Eigen::Index column, Eigen::VectorXf values) { columns_[column] = std::move(values); }

    /// χ², b, A and count. @param residual as the columns
    BlockInformation calcInformation(const Eigen::VectorXf& residual) const;
    /// b alone.
    Eigen::VectorXd project(const Eigen::VectorXf& residual) const;

private:
    Eigen::Index rows_ = 0;
    std::vector<Eigen::VectorXf> columns_;
};

/// Takes the last `count` unknowns, which belong to this run alone, out of an information.
/// @return by which b of those unknowns, taken off the others' b, takes them out of that (others x count)
Eigen::MatrixXd marginalise(BlockInformation& block, Eigen::Index count, double precision);

}  // namespace wems::identify
