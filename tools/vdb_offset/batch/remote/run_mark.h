// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vdb_offset::tool {

/// Where the models of a batch are done.
enum class Way { Here, SshLogin, Slurm };

/// The mark of a batch in its folder for as long as it is at work. Tasks on other machines end once it is gone, or that
/// of another batch is there: whatever became of the one that began them.
class RunMark {
 public:
  /// Ends what a batch before has left at work on other machines, and waits for that. \throw WriteError
  RunMark(const std::string& out, Way way);
  ~RunMark();
  RunMark(const RunMark&) = delete;
  RunMark& operator=(const RunMark&) = delete;

  /// A name that no other batch has; the name of its jobs at Slurm.
  const std::string& name() const { return name_; }

 private:
  std::string path_, name_;
};

/// The name of the batch that is at work on a folder; empty if none is.
std::string batch_at_work(const std::string& out);

}  // namespace vdb_offset::tool
