// SPDX-License-Identifier: Apache-2.0
#include "write/made_body.h"

#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <cstdint>
#include <sstream>

#include "ground/process/packing.h"

namespace vdb_offset::cad {

std::string pack(const MadeBody& made) {
  // One shape with all of them in it: faces stay those of the solids.
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : made.shapes) builder.Add(all, shape);
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, face] : made.faces) {
    numbers.push_back(number);
    builder.Add(all, face);
  }
  std::ostringstream bytes;
  BinTools::Write(all, bytes);
  Packer packer;
  packer.text(io::pack(made.facts))
      .value(std::uint64_t{made.shapes.size()})
      .list(numbers)
      .text(bytes.str())
      .value(made.may_be_better);
  return packer.take();
}

MadeBody unpack_body(std::string_view bytes) {
  Unpacker unpacker(bytes);
  MadeBody made;
  made.facts = io::unpack_written(unpacker.text());
  const auto shapes = unpacker.value<std::uint64_t>();
  const std::vector<std::uint64_t> numbers = unpacker.list<std::uint64_t>();
  std::istringstream stream(unpacker.text());
  made.may_be_better = unpacker.value<bool>();
  unpacker.end();
  TopoDS_Shape all;
  BinTools::Read(all, stream);
  std::size_t at = 0;
  for (TopoDS_Iterator each(all); each.More(); each.Next(), ++at)
    if (at < shapes) made.shapes.push_back(each.Value());
    else if (at - shapes < numbers.size()) made.faces.emplace_back(numbers[at - shapes], each.Value());
  return made;
}

}  // namespace vdb_offset::cad
