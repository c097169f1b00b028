#pragma once

#include <openvdb/openvdb.h>

#include <catch2/catch.hpp>
