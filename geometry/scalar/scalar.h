#pragma once

/// \file
/// Everything that makes double, lanes and dual numbers interchangeable as a scalar S.

#include <quiver/geometry/scalar/dual.h>
#include <quiver/geometry/scalar/dual_math.h>
#include <quiver/geometry/scalar/isa.h>
#include <quiver/geometry/scalar/lanes.h>
#include <quiver/geometry/scalar/lanes_math.h>
#include <quiver/geometry/scalar/libm_lanes.h>
#include <quiver/geometry/scalar/select.h>
