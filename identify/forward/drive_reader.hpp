/// @file
/// What acts at any time, from the tables of a drive, for one lane (of a Pack) after the other.
///
/// At a half step of the grid it is the row itself; between two (after a kink) load and base are the cubic through four
/// rows, the fixed part's motion what DriveRows::interpolate makes of both ends.
#pragma once

#include "identify/forward/drive.hpp"
#include "identify/forward/mount_kernel.hpp"
#include "identify/forward/pack.hpp"

namespace wems::identify {

template <class T>
class DriveReader {
public:
    explicit DriveReader(const DriveRows& drive) : drive_(drive) {}

    /// @param place half steps since the first row
    /// @param gain of the load's axes at all half steps, 3 for each; null = 1
    void read(double place, const double* gain, int l, Forcing<T>& forcing) const {
        int row = static_cast<int>(place);
        if (row > drive_.count - 1) row = drive_.count - 1;
        const double part = place - row;
        setLane(forcing.elapsed, l, drive_.elapsed + drive_.half_step * place);
        if (drive_.load != nullptr) {
            double value[3];
            interpolateRows(drive_.load, row, part, value);
            for (int i = 0; i < 3; ++i) value[i] += drive_.load_shift[i];
            if (gain != nullptr) multiply(value, gain + 3 * static_cast<long>(row), part);
            setVector(forcing.load, l, value);
        }
        if (drive_.base != nullptr) {
            double value[3];
            interpolateRows(drive_.base, row, part, value);
            setVector(forcing.base, l, value);
        }
        if (drive_.frames != nullptr) setFrame(forcing, l, row, part);
    }

private:
    static void multiply(double* value, const double* gain, double part) {
        for (int i = 0; i < 3; ++i) value[i] *= part > 0 ? gain[i] + part * (gain[i + 3] - gain[i]) : gain[i];
    }
    void interpolateRows(const double* table, int row, double part, double* value) const {
        const double* at = table + 3 * static_cast<long>(row);
        if (part == 0) {
            for (int i = 0; i < 3; ++i) value[i] = at[i];
            return;
        }
        // The cubic through four rows; a parabola or a line where there are fewer.
        const int first = row > 0 ? row - 1 : row, last = row + 2 < drive_.count ? row + 2 : row + 1;
        for (int i = 0; i < 3; ++i) value[i] = 0;
        for (int j = first; j <= last; ++j) {
            double weight = 1;
            for (int m = first; m <= last; ++m)
                if (m != j) weight *= (row + part - m) / (j - m);
            for (int i = 0; i < 3; ++i) value[i] += weight * table[3 * static_cast<long>(j) + i];
        }
    }
    void setFrame(Forcing<T>& forcing, int l, int row, double part) const {
        FrameRow between{};
        const FrameRow* frame = drive_.frames + row;
        if (part > 0) {
            drive_.interpolate(frame[0], frame[1], part, drive_.half_step, between);
            frame = &between;
        }
        setVector(forcing.R_GF.x, l, frame->R_GF);
        setVector(forcing.R_GF.y, l, frame->R_GF + 3);
        setVector(forcing.R_GF.z, l, frame->R_GF + 6);
        setVector(forcing.p_GF, l, frame->p_GF);
        setVector(forcing.w_GF, l, frame->w_GF);
        setVector(forcing.v_GF, l, frame->v_GF);
    }
    static void setVector(Vec3<T>& to, int l, const double* value) {
        setLane(to.x, l, value[0]);
        setLane(to.y, l, value[1]);
        setLane(to.z, l, value[2]);
    }

    const DriveRows& drive_;
};

}  // namespace wems::identify
