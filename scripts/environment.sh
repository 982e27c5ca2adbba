# Sourced by the other scripts: where things are, and an environment in which Debian's ROS works.
# These scripts do without `set -u`: ROS's setup.bash fails with it.
set -eo pipefail

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_dir=$(realpath -m "${BUILD_DIR:-$source_dir/_build}")

# Another python3 first in PATH (conda, pyenv) does not know catkin's modules.
export PATH=/usr/bin:$PATH
# ROS needs a host name that resolves and a folder it can write to, and a container may have neither.
export ROS_HOSTNAME=${ROS_HOSTNAME:-localhost}
export ROS_HOME=${ROS_HOME:-$build_dir/ros_home}
export PYTHONDONTWRITEBYTECODE=1

# --help prints the comment at the beginning of the script.
case ${1:-} in
  -h | --help)
    sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
esac

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}
