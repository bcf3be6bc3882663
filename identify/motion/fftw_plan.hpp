/// @file
/// FFTW's plans and complex numbers in C++.
#pragma once

#include <fftw3.h>

#include <complex>
#include <memory>

namespace wems::identify {

struct FftwPlanDeleter {
    void operator()(fftw_plan_s* plan) const { fftw_destroy_plan(plan); }
};
using FftwPlan = std::unique_ptr<fftw_plan_s, FftwPlanDeleter>;

/// The layouts are the same (FFTW manual, section 4.1.1).
inline fftw_complex* asFftw(std::complex<double>* data) {
    return reinterpret_cast<fftw_complex*>(data);
}

}  // namespace wems::identify
