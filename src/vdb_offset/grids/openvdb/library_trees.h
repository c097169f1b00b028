// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

// OpenVDB's library holds the virtual functions of these, but its headers do not say so. What is not virtual may be
// missing there, and is inlined where the compiler optimises.
#ifdef __OPTIMIZE__
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::Grid<openvdb::Int32Tree>;
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
#endif
