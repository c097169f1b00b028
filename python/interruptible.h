// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::python {

namespace py = pybind11;

/// Runs the library's work while Python goes on: its lock is released, Ctrl-C ends the work, and so does a progress
/// callback that returns False or raises an exception. \pre the caller holds Python's lock
class Interruptible {
 public:
  /// \param callback called with the stage's name and the share of it that is done, or None
  explicit Interruptible(py::object callback) : callback_(std::move(callback)) {}

  /// What the library is to call.
  ProgressCallback progress() {
    return [this](Stage stage, double share) { return tell(stage, share); };
  }

  /// Returns what work() returns, or throws what it throws. Python delivers signals to the thread that holds its lock,
  /// which is this one: the work has another.
  template <class Work>
  auto operator()(Work&& work) -> decltype(work()) {
    constexpr auto kBetweenSignals = std::chrono::milliseconds(50);
    std::future<decltype(work())> done;
    {
      const py::gil_scoped_release released;
      done = std::async(std::launch::async, std::forward<Work>(work));
      while (done.wait_for(kBetweenSignals) != std::future_status::ready) look_for_signals();
    }
    if (raised_) {
      try {
        done.get();
      } catch (...) {  // Cancelled, as was asked
      }
      std::rethrow_exception(std::exchange(raised_, nullptr));
    }
    return done.get();
  }

 private:
  void look_for_signals() {
    const py::gil_scoped_acquire held;
    if (!raised_ && PyErr_CheckSignals() != 0) keep_error();
  }
  /// Keeps Python's error, and has the work end.
  void keep_error() {
    raised_ = std::make_exception_ptr(py::error_already_set());
    is_cancelled_ = true;
  }
  bool tell(Stage stage, double share) {
    if (is_cancelled_ || callback_.is_none()) return !is_cancelled_;
    const py::gil_scoped_acquire held;
    try {
      const py::object answer = callback_(name(stage), share);
      return !answer.is(py::bool_(false));
    } catch (py::error_already_set& error) {
      error.restore();
      keep_error();
      return false;
    }
  }

  py::object callback_;
  std::exception_ptr raised_;
  std::atomic<bool> is_cancelled_ = false;
};

}  // namespace vdb_offset::python
