// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <future>
#include <thread>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::python {

namespace py = pybind11;

/// The calls that are going on, which the interpreter waits for before it ends: a thread that asked for its lock later
/// would be ended within the library.
class Calls {
 public:
  /// Has all calls end as soon as they can, and waits for them. \pre the caller holds Python's lock
  static void end() {
    is_ending = true;
    const py::gil_scoped_release released;
    while (count > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  static inline std::atomic<bool> is_ending = false;
  static inline std::atomic<int> count = 0;
};

/// Runs the library's work while Python goes on: its lock is released, Ctrl-C ends the work, and so does a progress
/// callback that returns what counts as false, but None, or raises an exception. \pre the caller holds Python's lock
class Interruptible {
 public:
  /// \param progress called with the stage's name and the share of it that is done, or None
  /// \param reserve called with the bytes that the work is about to take, or None
  explicit Interruptible(py::object progress, py::object reserve = py::none())
      : progress_(std::move(progress)), reserve_(std::move(reserve)) {
    ++Calls::count;
  }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible() { --Calls::count; }

  /// Has the library call what was handed in.
  template <class Options>
  void attach(Options& options) {
    options.progress = [this](Stage stage, double share) { return ask(progress_, name(stage), share); };
    if constexpr (requires { options.reserve; })
      options.reserve = [this](std::size_t bytes) { return ask(reserve_, bytes); };
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
  /// Whether the work is to go on, by a callback that may be None.
  template <class... Values>
  bool ask(const py::object& callback, const Values&... values) {
    if (is_cancelled_ || Calls::is_ending) return false;
    if (callback.is_none()) return true;
    const py::gil_scoped_acquire held;
    try {
      const py::object answer = callback(values...);
      if (answer.is_none()) return true;
      const int is_true = PyObject_IsTrue(answer.ptr());
      if (is_true < 0) throw py::error_already_set();
      return is_true == 1;
    } catch (py::error_already_set& error) {
      error.restore();
      keep_error();
      return false;
    }
  }

  py::object progress_, reserve_;
  std::exception_ptr raised_;
  std::atomic<bool> is_cancelled_ = false;
};

}  // namespace vdb_offset::python
