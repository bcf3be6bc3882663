/// @file
/// What a report draws of the two parts: simple shapes, or a surface from an STL file. Nothing is computed with it, so
/// that it stands in the model's file but not in the model.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems {

class TomlTable;

/// A [[drawing]] table of a model's file, in the frame of its part at rest:
///
///     part = "mobile"                  # or "fixed"
///     shape = "box"                    # or plate, cylinder, stl
///     size = [0.2, 0.2, 0.15]          # m; of a cylinder diameter and length along its z axis; of an STL none
///     position = [0.0, 0.0, 0.1]       # m, of the centre (of an STL: of its origin); absent = the part's origin
///     rotation = [0.0, 1.5708, 0.0]    # rotation vector, rad; absent = none
///     file = "box.stl"                 # of an STL, beside the model
///     scale = 0.001                    # m, of the STL's unit; absent = 1
struct DrawnShape {
    enum class Kind { box, plate, cylinder, stl };
    Part part = Part::mobile;
    Kind kind = Kind::box;
    Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< m; cylinder: diameter, diameter, length
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
    std::string path;  ///< of an STL, from the working folder
    double scale = 1;
};

/// `box`, `plate`, `cylinder`, `stl`
const char* nameShape(DrawnShape::Kind kind);

/// The drawing in the file of a model; empty: none, a stand-in is drawn. @throws InputError with file, line and key
std::vector<DrawnShape> readDrawing(const std::string& model_file);

/// One [[drawing]] table of the model file `file`. Internal to the readers.
DrawnShape readShape(TomlTable& table, const std::string& file);

/// Triangles of an STL file, text or binary: a column x y z of three corners for each, in the file's unit.
/// @throws InputError: not there, no STL, or more than 50 000 triangles
Eigen::Matrix<double, 9, Eigen::Dynamic> readStl(const std::string& file);

}  // namespace wems
