#pragma once

// Everything a program needs: graphs and their types, files, optimisation, plugins. Solvers and the inside of problems
// have headers of their own.
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/graph.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/initialization/automatic.h>
#include <quiver/initialization/chordal.h>
#include <quiver/initialization/spanning_tree.h>
#include <quiver/plugins/builtin.h>
#include <quiver/plugins/plugin.h>
#include <quiver/plugins/plugin_loader.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/edge_se2_prior.h>
#include <quiver/types_slam2d/edge_se2_xy.h>
#include <quiver/types_slam2d/edge_xy.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>
#include <quiver/types_slam3d/addons/euler_conversion.h>
#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/edge_se3_log.h>
#include <quiver/types_slam3d/edge_se3_prior.h>
#include <quiver/types_slam3d/edge_se3_xyz.h>
#include <quiver/types_slam3d/parameter_se3_offset.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>
#include <quiver/version.h>
