// Precompiled: the headers that cost most to read. No source relies on it.
#pragma once

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>
