#include "common/eigen_templates.h"

namespace Eigen {

LIMBER_EIGEN_TEMPLATES()

}  // namespace Eigen
