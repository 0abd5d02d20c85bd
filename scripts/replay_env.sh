#!/usr/bin/env bash
# Prints the environment in which OpenNI2 sees a folder of depth images as its camera, and no real camera:
#   eval "$(scripts/replay_env.sh FOLDER [OPTION=VALUE...])"
# Options: fps loop hold serial control mirror unit (doc/capture.md)
# VOXID_BUILD names the build folder (default: build beside scripts; installed: what lies beside this file).
set -euo pipefail
here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
folder=${1:-}
if [ -z "$folder" ] || [ "$folder" = -h ] || [ "$folder" = --help ]; then
  sed -n '2,5s/^# *//p' "${BASH_SOURCE[0]}"
  [ -n "$folder" ] && exit 0
  exit 2
fi
[ -d "$folder" ] || { echo "replay_env: there is no folder $folder" >&2; exit 1; }
shift

layout=${VOXID_BUILD:-$here/../build}/openni2
[ -d "$here/openni2" ] && layout=$here/openni2
[ -e "$layout/OpenNI2/Drivers/libVoxidReplay.so.0" ] || {
  echo "replay_env: the replay driver is not built" \
    "(looked for $layout/OpenNI2/Drivers/libVoxidReplay.so.0); run scripts/build" >&2
  exit 1
}

printf 'export LD_LIBRARY_PATH=%q\n' "$(cd "$layout" && pwd)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
printf 'export VOXID_REPLAY=%q\n' "$(cd "$folder" && pwd)"
for option in "$@"; do
  case "$option" in
    fps=*|loop=*|hold=*|serial=*|control=*|mirror=*|unit=*)
      name=${option%%=*}
      printf 'export VOXID_REPLAY_%s=%q\n' "${name^^}" "${option#*=}" ;;
    *)
      echo "replay_env: '$option' is not an option;" \
        "expected fps=, loop=, hold=, serial=, control=, mirror= or unit=" >&2
      exit 2 ;;
  esac
done
