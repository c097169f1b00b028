// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "ground/system/temporary.h"
#include "support/folder.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace fs = std::filesystem;
using namespace vdb_offset;

namespace {

std::size_t count_entries(const Folder& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()));
}

/// Of a process that has been and is no more.
pid_t ended_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

std::string with_process(std::string name, pid_t process) {
  const std::string ours = "-" + std::to_string(::getpid()) + "-";
  return name.replace(name.find(ours), ours.size(), "-" + std::to_string(process) + "-");
}

}  // namespace

TEST_CASE("replace: files are put in place together, or not at all", "[io]") {
  const Folder folder;
  const std::string a = folder.write("a.txt", "old a"), b = folder.file("b.txt"), c = folder.write("c.txt", "old c");
  const auto write_all = [&] {
    for (const std::string& path : {a, b, c}) write_file(path, "new");
  };
  {
    OutputFiles files;
    write_all();
    CHECK(slurp(a) == "old a");
    CHECK_FALSE(fs::exists(b));
  }
  CHECK(slurp(a) == "old a");
  CHECK(count_entries(folder) == 2);
  {
    OutputFiles files;
    write_all();
    fs::remove(c);
    fs::create_directory(c);  // the last one cannot be replaced any more
    CHECK_THROWS_AS(files.commit(), WriteError);
  }
  CHECK(slurp(a) == "old a");
  CHECK_FALSE(fs::exists(b));
  CHECK(count_entries(folder) == 2);
  fs::remove(c);
  fs::permissions(a, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  bool in_place = false;
  OutputFiles files;
  write_all();
  files.commit([&] { in_place = slurp(a) == "new" && slurp(b) == "new" && slurp(c) == "new"; });
  CHECK(in_place);
  CHECK(fs::status(a).permissions() == (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
  CHECK(count_entries(folder) == 3);
}

TEST_CASE("replace: what is put in place within another goes with that one", "[io]") {
  const Folder folder;
  const std::string path = folder.file("made/for/it/a.txt");
  {
    OutputFiles outer;
    {
      OutputFiles inner;
      inner.add_folders(folder.path / "made/for/it");
      write_file(path, "new");
      inner.commit();
    }
    CHECK_FALSE(fs::exists(path));
  }
  CHECK(count_entries(folder) == 0);
  OutputFiles outer(OutputFiles::Sync::No);
  {
    OutputFiles inner;
    inner.add_folders(folder.path / "made/for/it");
    write_file(path, "new");
    inner.commit();
  }
  outer.commit();
  CHECK(slurp(path) == "new");
}

TEST_CASE("replace: names as long as the file system takes, links and pipes", "[io]") {
  const Folder folder;
  const std::string longest = folder.file(std::string(255, 'n')), longer = folder.file(std::string(256, 'n'));
  write_file(longest, "new");
  CHECK(slurp(longest) == "new");
  require_writable(longest);
  CHECK_THROWS_AS(require_writable(longer), WriteError);
  CHECK_THROWS_AS(write_file(longer, "new"), WriteError);
  const std::string ending = folder.file("a.").append(200, 'e');
  write_file(ending, "new");
  CHECK(slurp(ending) == "new");
  fs::create_symlink(longest, folder.path / "link");
  write_file(folder.file("link"), "newer");
  CHECK(fs::is_symlink(folder.path / "link"));
  CHECK(slurp(longest) == "newer");
  REQUIRE(::mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  std::string got;
  std::thread reader([&] { got = slurp(folder.file("pipe")); });
  write_file(folder.file("pipe"), "through");
  reader.join();
  CHECK(got == "through");
}

TEST_CASE("replace: temporary files of runs that were killed go, others stay", "[io]") {
  const Folder folder;
  const fs::path target = folder.path / "a.txt";
  const Temporary ours = new_temporary_file(target, "a.txt");
  CHECK(ours.path().ends_with(".txt"));
  const std::string stale = with_process(ours.path(), ended_process()), alive = with_process(ours.path(), ::getppid());
  std::string elsewhere = stale;  // of another machine
  elsewhere[elsewhere.find(".vdb_offset-") + 12] ^= 1;
  for (const std::string& path : {stale, alive, elsewhere}) std::ofstream(path) << "half";
  write_file(target.string(), "new");
  CHECK_FALSE(fs::exists(stale));
  CHECK(fs::exists(alive));
  CHECK(fs::exists(elsewhere));
  CHECK(fs::exists(ours.path()));
}

TEST_CASE("replace: many threads write at once, and a handler finds what is theirs", "[io]") {
  const Folder folder;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&folder, t] {
      for (int i = 0; i < 50; ++i) write_file(folder.file(std::to_string(t) + ".txt"), std::to_string(i));
    });
  for (std::thread& thread : threads) thread.join();
  for (int t = 0; t < 8; ++t) CHECK(slurp(folder.file(std::to_string(t) + ".txt")) == "49");
  CHECK(count_entries(folder) == 8);
  // In a process of its own, which has to end afterwards.
  const pid_t child = ::fork();
  if (child == 0) {
    OutputFiles files(OutputFiles::Sync::No);
    files.add_folders(folder.path / "x/y");
    write_file(folder.file("x/y/a"), "new");
    write_file(folder.file("0.txt"), "new");
    ::_exit(remove_temporaries() ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  CHECK(status == 0);
  CHECK(slurp(folder.file("0.txt")) == "49");
  CHECK(count_entries(folder) == 8);
}
