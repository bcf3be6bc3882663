#define WEMS_EIGEN_INSTANCE template
#include "models/common/eigen_instances.hpp"
