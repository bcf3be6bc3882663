#include "tests/hidden/random_numbers.hpp"

#include <cmath>

namespace wems::hidden {

double drawUniform(Random& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

double drawLog(Random& random, double lower, double upper) {
    return std::exp(drawUniform(random, std::log(lower), std::log(upper)));
}

int drawInteger(Random& random, int lower, int upper) {
    return std::uniform_int_distribution<int>(lower, upper)(random);
}

double drawSign(Random& random) {
    return drawInteger(random, 0, 1) == 0 ? -1.0 : 1.0;
}

bool drawCoin(Random& random, double probability) {
    return drawUniform(random, 0, 1) < probability;
}

}  // namespace wems::hidden
