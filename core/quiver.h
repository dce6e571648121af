#pragma once

// Everything a program needs: graphs and their types, files, optimisation, plugins. Solvers and the inside of problems
// have headers of their own.
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/graph.h>
#include <quiver/core/io/g2o_reader.h>
#include <quiver/core/io/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/plugins/plugin.h>
#include <quiver/plugins/plugin_loader.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/version.h>
