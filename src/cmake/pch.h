// SPDX-License-Identifier: Apache-2.0
// Precompiled: the headers that cost most to read. No source relies on it.
#pragma once

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>

// OpenVDB's library holds the virtual functions of these, but its headers do not say so: compiled again in every source
// that makes a grid, they would take a third of the time that the project takes to build. What is not virtual may be
// missing there, and is inlined where the compiler optimises.
#ifdef __OPTIMIZE__
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::Grid<openvdb::Int32Tree>;
extern template class openvdb::Grid<openvdb::Vec3STree>;
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
#endif
