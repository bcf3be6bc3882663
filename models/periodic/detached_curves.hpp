/// @file
/// Response curves that are not connected with the low end of the band (detached resonances, isolas).
///
/// At one frequency the amplitude over the level is a curve of its own, which at most frequencies leads from rest
/// through all motions: up, around folds, back and up again. It is followed to a multiple of the level, at the folds of
/// the curves that are known and at frequencies all over the band. Where it passes the level, a motion that lies on no
/// known curve belongs to a detached one. Source: the level curves ("S-curves") of Renson, Shaw, Barton, Neild (2019),
/// doi:10.1016/j.ymssp.2018.09.012, computed here in place of measured.
#pragma once

#include <vector>

#include "models/periodic/continuation.hpp"

namespace wems {

struct DetachedSearch {
    double from = 0, to = 0;      ///< Hz
    double highest_level = 4;     ///< of the level curves, over the level that is asked for
    int frequencies = 16;         ///< over the band, besides those of the folds
    std::size_t most_curves = 8;  ///< that are followed
};

struct DetachedCurve {
    std::vector<CurvePoint> points;
    std::string incomplete;  ///< why it ends within the band without having closed; empty otherwise
};

/// @param along over the frequency, as the known curve was followed
/// @param known the points of the curve from the low end of the band
/// @param folds Hz, of that curve
std::vector<DetachedCurve> findDetachedCurves(const HarmonicBalance& balance, const Continuation& along,
                                              const std::vector<CurvePoint>& known, const std::vector<double>& folds,
                                              const DetachedSearch& search);

}  // namespace wems
