/// @file
/// Random numbers of the hidden cases.
#pragma once

#include <random>

namespace wems::hidden {

using Random = std::mt19937_64;

double drawUniform(Random& random, double lower, double upper);
double drawLog(Random& random, double lower, double upper);
int drawInteger(Random& random, int lower, int upper);
double drawSign(Random& random);
bool drawCoin(Random& random, double probability);

}  // namespace wems::hidden
