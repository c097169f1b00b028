// SPDX-License-Identifier: Apache-2.0
// Makes parts, and judges their offsets, by OpenCASCADE alone; see kUsage.
#include <BRepCheck_Analyzer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "cad/proof/judge_files.h"
#include "cad/proof/parts.h"
#include "cad/proof/random_part.h"

namespace {

using namespace cad_proof;

constexpr const char* kUsage =
    "vdb_offset_cad_proof part NAME FILE      one of ten parts; prints its diagonal and volume\n"
    "vdb_offset_cad_proof random SEED FILE    a random part; prints its distance and volume; exit 4 if there is none\n"
    "vdb_offset_cad_proof judge SOURCE RESULT DISTANCE N\n"
    "    prints the volume of an offset, how far its faces are off at N equal (u, v), and its faults; exit 3 if any\n";

constexpr int kNoPart = 4, kFaulty = 3, kPoints = 80;

int make_part(const std::string& name, const std::string& file) {
  for (const auto& [its_name, make] : parts()) {
    if (its_name != name) continue;
    const TopoDS_Shape part = make();
    write_step(part, file);
    std::printf("%.4f %.9g\n", diagonal_of(part), volume_of(part));
    return 0;
  }
  throw std::runtime_error("there is no part " + name);
}

int make_random_part(std::uint64_t seed, const std::string& file) {
  const TopoDS_Shape part = random_part(seed);
  if (part.IsNull()) return kNoPart;
  write_step(part, file);
  // What OpenCASCADE does not read as it wrote it is no part.
  if (!BRepCheck_Analyzer(read_step(file).shape).IsValid()) return kNoPart;
  std::printf("%.4f %.9g\n", diagonal_of(part) * random_share(seed), volume_of(part));
  return 0;
}

int judge(const std::string& source, const std::string& result, double distance, int equal_points) {
  const Findings findings = judge_files(read_step(source), read_step(result), distance, {kPoints, equal_points});
  std::printf("volume %.6g, %d points, least %.6f of the distance\n", findings.volume, findings.points, findings.least);
  std::printf("%d faces, %d points at equal (u, v), worst %.3e of the distance on %s\n", findings.equal.faces,
              findings.equal.points, findings.equal.worst, findings.equal.worst_of.c_str());
  for (const std::string& fault : findings.faults) std::printf("%s\n", fault.c_str());
  return findings.faults.empty() ? 0 : kFaulty;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 3 && words[0] == "part") return make_part(words[1], words[2]);
  if (words.size() == 3 && words[0] == "random") return make_random_part(std::stoull(words[1]), words[2]);
  if (words.size() == 5 && words[0] == "judge")
    return judge(words[1], words[2], std::stod(words[3]), std::stoi(words[4]));
  throw std::runtime_error(kUsage);
}

}  // namespace

int main(int count, char** words) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  try {
    return run({words + 1, words + count});
  } catch (const Standard_Failure& failure) {
    std::fprintf(stderr, "OpenCASCADE fails: %s\n", failure.GetMessageString());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 1;
}
