/// @file
/// Which blocks of a long recording a fit should see, chosen while they pass by.
///
/// Each block has an information matrix JᵀJ for all parameters of the fit (scaled), J the derivative of its equations
/// of motion, of errors alike in all blocks. Of all sets of so many blocks the best is the one with the largest
/// determinant of the sum (D-optimal: the smallest volume of the confidence ellipsoid). Once the set is full a new
/// block takes the place of the one that it improves the determinant most for, if it does so by more than 2 %. One
/// pass, so that the set is near the best one, not proven to be it.
///
/// A stop's columns depend on its clearance, which is not known yet: the mean of the information with the model's
/// clearances and with 0.6 of them counts.
///
/// Sources: Fedorov, Theory of Optimal Experiments (1972), the exchange; Wynn (1970), the sequence.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/fit/normal_equations.hpp"

namespace wems::identify {

class BlockChoice {
public:
    /// @param most blocks kept, ≥ 1
    BlockChoice(const MountModel& model, const FitOptions& options, std::size_t most);

    /// @throws InputError if the block is too short for the test function
    void offer(RunMotion block);

    std::size_t offeredCount() const { return offered_; }
    std::size_t keptCount() const { return kept_.size(); }
    /// The blocks kept, in the order in which they were offered; the choice is empty then.
    std::vector<RunMotion> takeBlocks();

    /// Standard errors to be expected from the blocks kept over those from all, at equal errors in all blocks: median
    /// and largest over the parameters. ≥ 1.
    struct Cost {
        double median = 1, largest = 1;
        std::string parameter;  ///< of the largest
    };
    Cost calcCost() const;
    /// Logarithm of the determinant of the information kept, the parameters scaled: what is made large.
    double calcLevel() const;
    std::size_t parameterCount() const { return parameters_.size(); }

private:
    Eigen::MatrixXd calcInformation(const RunMotion& block) const;

    struct Block {
        std::size_t number = 0;
        RunMotion motion;
        Eigen::MatrixXd information;
    };

    MountModel model_;
    FitOptions options_;
    std::size_t most_;
    std::vector<Parameter> parameters_;
    std::vector<StopTerm> stops_;
    Eigen::VectorXd scale_;
    Matrix6d weights_;  // equations to errors of unit size
    std::vector<Block> kept_;
    Eigen::MatrixXd kept_information_, all_information_;
    std::size_t offered_ = 0;
};

/// Memory that fitMount() takes for each sample, the motion included, bytes: as if every sample gave an equation.
double calcFitMemory(const MountModel& model, const FitOptions& options);

}  // namespace wems::identify
