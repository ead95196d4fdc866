// SPDX-License-Identifier: GPL-3.0-or-later

/// Of the channels; exact where they are equal.
float mean_of(vec3 color) { return color.r + ((color.g - color.r) + (color.b - color.r)) / 3.0; }
