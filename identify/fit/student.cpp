#include "identify/fit/student.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <limits>

namespace wems::identify {

double studentQuantile95(double degrees_of_freedom) {
    if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::infinity();
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

}  // namespace wems::identify
