#define WEMS_EIGEN_INSTANCE template
#include "models/eigen_instances.hpp"
