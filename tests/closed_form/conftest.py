# SPDX-License-Identifier: GPL-3.0-or-later
import pytest


@pytest.fixture(params=["REFERENCE", "SIMD", "COMPUTE"])
def executor(request):
    """Every executor that takes any sampling; each closed form holds for all of them."""
    return request.param
