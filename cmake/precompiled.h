// SPDX-License-Identifier: GPL-3.0-or-later
// What nearly every file includes, read by the compiler once a build: no file includes this one,
// and each still includes what it uses (builds with sanitizers and the portable one have no
// precompiled headers).  GLM is here as nearly all know it by vec.h; the library base does not.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "math/vec.h"
