/// @file
/// Where in frequency one more mode would take away most of a residual, and with what shape.
///
/// A mode that a model lacks leaves r(ω) = −h(ω) φ pᵀ u(ω), h = 1/(ω_j² − ω² + 2 i ζ ω_j ω), u the spectra of what
/// drives the modes, p the mode's participation in them; the first six of u are the wrench at the interface, where the
/// mode has the shape φ, so that φ is the head of p. For given ω_j and ζ, the matrix A = φ pᵀ follows from linear least
/// squares; its largest singular pair starts a Gauss–Newton iteration for p. A mode cannot give energy: a matrix whose
/// head has no positive part is no mode.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace wems::identify {

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

}  // namespace wems::identify
