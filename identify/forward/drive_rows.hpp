/// @file
/// What drives a simulation as the integrator reads it: plain tables.
#pragma once

namespace wems::identify {

/// Prescribed motion of the fixed part at one time, by columns.
struct FrameRow {
    double R_GF[9], p_GF[3], w_GF[3], v_GF[3];
};

/// What drives, at all half steps of the grid.
struct DriveRows {
    const double* load = nullptr;      ///< 3 for each half step; null without
    const double* base = nullptr;      ///< likewise
    const FrameRow* frames = nullptr;  ///< likewise
    /// The motion at a part (0…1) between two rows, h (s) apart.
    void (*interpolate)(const FrameRow& from, const FrameRow& to, double part, double h, FrameRow& between) = nullptr;
    double elapsed = 0, half_step = 0;  ///< s: at the first half step, and between two
    int count = 0;
};

}  // namespace wems::identify
