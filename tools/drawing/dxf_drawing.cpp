// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/dxf_drawing.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"

namespace adit {
namespace {

// Handles, in hexadecimal, of what every drawing has; layers and entities follow.
constexpr unsigned kModelSpace = 0x20;
constexpr unsigned kPaperSpace = 0x21;
constexpr unsigned kFirstLayer = 0x100;
constexpr int kTenthsOfMillimetres = 4;  // decimals

std::string coordinate(double value) {
  return with_decimals(value, kTenthsOfMillimetres);
}

std::string variable(const char* name, int code, const std::string& value) {
  return fmt::format("9\n{}\n{}\n{}\n", name, code, value);
}

std::string corner_variable(const char* name, const Eigen::Vector3d& p) {
  return fmt::format("9\n{}\n10\n{}\n20\n{}\n30\n{}\n", name, coordinate(p.x()), coordinate(p.y()),
                     coordinate(p.z()));
}

/// A table with its entries.
std::string table(const char* name, const char* handle, std::size_t entries,
                  const std::string& text, const char* more = "") {
  return fmt::format(
      "0\nTABLE\n2\n{}\n5\n{}\n330\n0\n100\nAcDbSymbolTable\n70\n{}\n{}{}0\nENDTAB\n", name, handle,
      entries, more, text);
}

std::string table_entry(const char* type, const std::string& handle, const char* owner,
                        const char* subclass, const std::string& name) {
  return fmt::format("0\n{}\n5\n{}\n330\n{}\n100\nAcDbSymbolTableRecord\n100\n{}\n2\n{}\n", type,
                     handle, owner, subclass, name);
}

/// The view that a program opens with: all of the drawing.
std::string view_port(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d middle = box.center();
  const double height = std::max({1.0, box.sizes().y(), box.sizes().x() / 1.5});
  return table_entry("VPORT", "30", "1", "AcDbViewportTableRecord", "*ACTIVE") +
         fmt::format(
             "70\n0\n10\n0.0\n20\n0.0\n11\n1.0\n21\n1.0\n12\n{}\n22\n{}\n13\n0.0\n23\n0.0\n14\n1."
             "0\n"
             "24\n1.0\n15\n0.0\n25\n0.0\n16\n0.0\n26\n0.0\n36\n1.0\n17\n0.0\n27\n0.0\n37\n0.0\n"
             "40\n{}\n41\n1.5\n42\n50.0\n43\n0.0\n44\n0.0\n50\n0.0\n51\n0.0\n71\n0\n72\n1000\n"
             "73\n1\n74\n3\n75\n0\n76\n0\n77\n0\n78\n0\n",
             coordinate(middle.x()), coordinate(middle.y()), coordinate(1.05 * height));
}

std::string line_type(const char* handle, const char* name, const char* about) {
  return table_entry("LTYPE", handle, "2", "AcDbLinetypeTableRecord", name) +
         fmt::format("70\n0\n3\n{}\n72\n65\n73\n0\n40\n0.0\n", about);
}

std::string layer_entry(unsigned handle, const DxfLayer& layer) {
  return table_entry("LAYER", fmt::format("{:X}", handle), "3", "AcDbLayerTableRecord",
                     layer.name) +
         fmt::format("70\n0\n62\n{}\n6\nContinuous\n370\n-3\n390\n14\n", layer.color);
}

std::string block(const char* name, unsigned record, const char* begin, const char* end,
                  bool paper) {
  const char* const space = paper ? "67\n1\n" : "";
  return fmt::format(
      "0\nBLOCK\n5\n{1}\n330\n{0:X}\n100\nAcDbEntity\n{4}8\n0\n100\nAcDbBlockBegin\n2\n{3}\n70\n0\n"
      "10\n0.0\n20\n0.0\n30\n0.0\n3\n{3}\n1\n\n"
      "0\nENDBLK\n5\n{2}\n330\n{0:X}\n100\nAcDbEntity\n{4}8\n0\n100\nAcDbBlockEnd\n",
      record, begin, end, name, space);
}

std::string section(const char* name, const std::string& content) {
  return fmt::format("0\nSECTION\n2\n{}\n{}0\nENDSEC\n", name, content);
}

std::string tables(const std::vector<DxfLayer>& layers, const Eigen::AlignedBox3d& box) {
  std::string of_layers = layer_entry(0x40, {.name = "0"});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    of_layers += layer_entry(kFirstLayer + static_cast<unsigned>(i), layers[i]);
  }
  return table("VPORT", "1", 1, view_port(box)) +
         table("LTYPE", "2", 3,
               line_type("31", "ByBlock", "") + line_type("32", "ByLayer", "") +
                   line_type("33", "Continuous", "Solid line")) +
         table("LAYER", "3", layers.size() + 1, of_layers) +
         table("STYLE", "4", 1,
               table_entry("STYLE", "34", "4", "AcDbTextStyleTableRecord", "Standard") +
                   "70\n0\n40\n0.0\n41\n1.0\n50\n0.0\n71\n0\n42\n2.5\n3\ntxt\n4\n\n") +
         table("VIEW", "5", 0, "") + table("UCS", "6", 0, "") +
         table("APPID", "7", 1,
               table_entry("APPID", "35", "7", "AcDbRegAppTableRecord", "ACAD") + "70\n0\n") +
         table("DIMSTYLE", "8", 1,
               "0\nDIMSTYLE\n105\n36\n330\n8\n100\nAcDbSymbolTableRecord\n100\n"
               "AcDbDimStyleTableRecord\n2\nStandard\n70\n0\n",
               "100\nAcDbDimStyleTable\n") +
         table("BLOCK_RECORD", "9", 2,
               table_entry("BLOCK_RECORD", fmt::format("{:X}", kModelSpace), "9",
                           "AcDbBlockTableRecord", "*Model_Space") +
                   "340\n15\n" +
                   table_entry("BLOCK_RECORD", fmt::format("{:X}", kPaperSpace), "9",
                               "AcDbBlockTableRecord", "*Paper_Space") +
                   "340\n16\n");
}

/// An arrangement of a sheet, which model space is one of, too.
std::string layout(const char* handle, const char* name, int order, unsigned space) {
  return fmt::format(
      "0\nLAYOUT\n5\n{}\n330\n12\n100\nAcDbPlotSettings\n1\n\n2\nnone_device\n4\n\n6\n\n40\n0."
      "0\n41\n"
      "0.0\n42\n0.0\n43\n0.0\n44\n0.0\n45\n0.0\n46\n0.0\n47\n0.0\n48\n0.0\n49\n0.0\n140\n0.0\n141\n"
      "0.0\n142\n1.0\n143\n1.0\n70\n{}\n72\n1\n73\n0\n74\n5\n7\n\n75\n16\n147\n1.0\n148\n0.0\n149\n"
      "0.0\n100\nAcDbLayout\n1\n{}\n70\n1\n71\n{}\n10\n0.0\n20\n0.0\n11\n420.0\n21\n297.0\n12\n0."
      "0\n"
      "22\n0.0\n32\n0.0\n14\n0.0\n24\n0.0\n34\n0.0\n15\n0.0\n25\n0.0\n35\n0.0\n146\n0.0\n13\n0.0\n"
      "23\n0.0\n33\n0.0\n16\n1.0\n26\n0.0\n36\n0.0\n17\n0.0\n27\n1.0\n37\n0.0\n76\n0\n330\n{:X}\n",
      handle, order == 0 ? 1712 : 688, name, order, space);
}

/// Objects of kinds that came after AutoCAD's first.
std::string classes() {
  std::string text;
  for (const auto& [name, type] :
       {std::pair("ACDBDICTIONARYWDFLT", "AcDbDictionaryWithDefault"),
        std::pair("ACDBPLACEHOLDER", "AcDbPlaceHolder"), std::pair("LAYOUT", "AcDbLayout")}) {
    text += fmt::format("0\nCLASS\n1\n{}\n2\n{}\n3\nObjectDBX Classes\n90\n0\n280\n0\n281\n0\n",
                        name, type);
  }
  return text;
}

/// Dictionaries that programs look for.
std::string objects() {
  const auto dictionary = [](const char* handle, const char* owner, const std::string& entries) {
    return fmt::format("0\nDICTIONARY\n5\n{}\n330\n{}\n100\nAcDbDictionary\n281\n1\n{}", handle,
                       owner, entries);
  };
  return dictionary("10", "0",
                    "3\nACAD_GROUP\n350\n11\n3\nACAD_LAYOUT\n350\n12\n3\nACAD_PLOTSTYLENAME\n350\n"
                    "13\n") +
         dictionary("11", "10", "") +
         dictionary("12", "10", "3\nModel\n350\n15\n3\nLayout1\n350\n16\n") +
         "0\nACDBDICTIONARYWDFLT\n5\n13\n330\n10\n100\nAcDbDictionary\n281\n1\n3\nNormal\n350\n14\n"
         "100\nAcDbDictionaryWithDefault\n340\n14\n0\nACDBPLACEHOLDER\n5\n14\n330\n13\n" +
         layout("15", "Model", 0, kModelSpace) + layout("16", "Layout1", 1, kPaperSpace);
}

}  // namespace

DxfDrawing::DxfDrawing(std::vector<DxfLayer> layers, std::string remark)
    : layers_(std::move(layers)),
      remark_(std::move(remark)),
      next_handle_(kFirstLayer + static_cast<unsigned>(layers_.size())) {
  std::ranges::replace(remark_, '\n', ' ');
}

std::string DxfDrawing::begin(const char* type, const std::string& layer, const char* subclass) {
  return fmt::format("0\n{}\n5\n{:X}\n330\n{:X}\n100\nAcDbEntity\n8\n{}\n100\n{}\n", type,
                     next_handle_++, kModelSpace, layer, subclass);
}

void DxfDrawing::line(const std::string& layer, const Eigen::Vector2d& from,
                      const Eigen::Vector2d& to) {
  entities_ +=
      begin("LINE", layer, "AcDbLine") +
      fmt::format("10\n{}\n20\n{}\n30\n0.0\n11\n{}\n21\n{}\n31\n0.0\n", coordinate(from.x()),
                  coordinate(from.y()), coordinate(to.x()), coordinate(to.y()));
  box_.extend(Eigen::Vector3d(from.x(), from.y(), 0.0));
  box_.extend(Eigen::Vector3d(to.x(), to.y(), 0.0));
}

void DxfDrawing::point(const std::string& layer, const Eigen::Vector2d& at) {
  entities_ += begin("POINT", layer, "AcDbPoint") +
               fmt::format("10\n{}\n20\n{}\n30\n0.0\n", coordinate(at.x()), coordinate(at.y()));
  box_.extend(Eigen::Vector3d(at.x(), at.y(), 0.0));
}

void DxfDrawing::polyline(const std::string& layer, std::span<const Eigen::Vector2d> corners,
                          bool closed, double height) {
  entities_ +=
      begin("LWPOLYLINE", layer, "AcDbPolyline") +
      fmt::format("90\n{}\n70\n{}\n38\n{}\n", corners.size(), closed ? 1 : 0, coordinate(height));
  for (const Eigen::Vector2d& corner : corners) {
    entities_ += fmt::format("10\n{}\n20\n{}\n", coordinate(corner.x()), coordinate(corner.y()));
    box_.extend(Eigen::Vector3d(corner.x(), corner.y(), height));
  }
}

std::string DxfDrawing::str() const {
  const Eigen::AlignedBox3d box =
      box_.isEmpty() ? Eigen::AlignedBox3d(Eigen::Vector3d::Zero()) : box_;
  const std::string header =
      variable("$ACADVER", 1, "AC1015") + variable("$DWGCODEPAGE", 3, "ANSI_1252") +
      variable("$HANDSEED", 5, fmt::format("{:X}", next_handle_)) +
      corner_variable("$EXTMIN", box.min()) + corner_variable("$EXTMAX", box.max()) +
      variable("$INSUNITS", 70, "6") +     // metres
      variable("$LUNITS", 70, "2") +       // decimal
      variable("$MEASUREMENT", 70, "1") +  // metric line types
      variable("$PSTYLEMODE", 290, "1");   // plot styles by colour
  const std::string blocks = block("*Model_Space", kModelSpace, "22", "23", false) +
                             block("*Paper_Space", kPaperSpace, "24", "25", true);
  return "999\n" + remark_ + "\n" + section("HEADER", header) + section("CLASSES", classes()) +
         section("TABLES", tables(layers_, box)) + section("BLOCKS", blocks) +
         section("ENTITIES", entities_) + section("OBJECTS", objects()) + "0\nEOF\n";
}

}  // namespace adit
