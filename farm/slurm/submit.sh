#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# submit.sh SCENE OUTPUT FIRST LAST [PARTS] [SBATCH-OPTION]...
#
# Sends the frames FIRST to LAST of SCENE to Slurm, one task a frame; with PARTS above 1 one task a
# part, and a second array that joins them when all of them are there.  OUTPUT is as Blender takes
# it: /render/frame_####.  Prints the number of the last job.  GRANITA_BLENDER names the program.
set -euo pipefail
(($# >= 4)) || { sed -n '3,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
script=$(dirname "$(readlink -f "$0")")/granita.sbatch
export GRANITA_SCENE GRANITA_OUTPUT=$2 GRANITA_FIRST=$3 GRANITA_PARTS=${5:-1} GRANITA_STEP=frame
GRANITA_SCENE=$(readlink -f "$1")
first=$3 last=$4
shift $(($# < 5 ? 4 : 5))
if ((GRANITA_PARTS == 1)); then
    sbatch --parsable --array="$first-$last" "$@" "$script"
else
    GRANITA_STEP=part
    tasks=$(((last - first + 1) * GRANITA_PARTS))
    parts=$(sbatch --parsable --array="1-$tasks" "$@" "$script")
    GRANITA_STEP=merge
    sbatch --parsable --array="$first-$last" --dependency="afterok:$parts" --kill-on-invalid-dep=yes "$@" "$script"
fi
