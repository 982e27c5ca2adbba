#!/usr/bin/env bash
# Installs what is built, and uses it as others do: from plain CMake, from a catkin package, by pkg-config, from Python,
# and live. Usage: test_install.sh BUILD_DIR, configured with an install prefix within that folder, since catkin writes the
# prefix into what it installs. Leaves nothing: rosrun and roslaunch would find what is installed below the package, too, and
# would not choose.
source "$(dirname "$0")/../../scripts/environment.sh"

build=$(cd "$1" && pwd)
work=$build/test_install
prefix=$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")
case $prefix in
  "$build"/*) ;;
  *) fail "configure with -DCMAKE_INSTALL_PREFIX=$build/.install to run this test: the prefix is $prefix" ;;
esac
rm -rf "$work" "$prefix"
mkdir -p "$work"
launched=
clean_up() {
  [ -z "$launched" ] || { kill "$launched" && wait "$launched" || true; } 2>/dev/null
  rm -rf "$work" "$prefix"
}
trap clean_up EXIT
# Nothing of the build may help.
clean=(env -i PATH=/usr/bin:/bin HOME="$work" ROS_HOSTNAME="$ROS_HOSTNAME" ROS_HOME="$work/ros_home" PYTHONDONTWRITEBYTECODE=1)

say "Installing"
cmake --install "$build" >"$work/install.log"
[ -e "$prefix/setup.bash" ] || fail "no setup.bash in the install tree"
if grep -rIl -e "$source_dir/include" -e "$source_dir/src" -e "$build/devel" "$prefix"; then
  fail "the files above name the source or the build tree, which a user of the install tree need not have"
fi

say "Examples, with plain CMake"
"${clean[@]}" cmake -S "$source_dir/examples" -B "$work/examples" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
"${clean[@]}" cmake --build "$work/examples" -j2 >/dev/null
expect() { # what a command must print
  local text=$1
  shift
  "$@" | tee "$work/output.txt"
  grep -q -e "$text" "$work/output.txt" || fail "$* did not print '$text'"
}
expect "x = 520: 2 .* source 2" "${clean[@]}" "$work/examples/01_fuse_a_pair"
expect "frame 89 .* [1-9][0-9]* of both" "${clean[@]}" "$work/examples/02_follow_a_sequence"
expect "^1 m: sigma 0.0044" "${clean[@]}" "$work/examples/03_your_own_sensor"

say "pkg-config"
flags=$("${clean[@]}" PKG_CONFIG_PATH="$prefix/lib/pkgconfig" pkg-config --cflags --libs rgbd_sfm_fusion)
# shellcheck disable=SC2086
g++ -std=c++17 "$source_dir/examples/01_fuse_a_pair.cpp" -o "$work/by_pkg_config" $flags
expect "x = 520: 2 " env LD_LIBRARY_PATH="$prefix/lib" "$work/by_pkg_config"

say "A catkin package"
"${clean[@]}" bash -c "source '$prefix/setup.bash' && cmake -S '$source_dir/test/install/catkin_client' -B '$work/client' >/dev/null &&
  cmake --build '$work/client' >/dev/null"
expect "core found" "${clean[@]}" "$(find "$work/client/devel/lib" -name catkin_client -type f)"

say "Python, and the page that fuse_bag makes"
expect "runs.py.*msg" "${clean[@]}" bash -c "source '$prefix/setup.bash' &&
  python3 -c 'import rgbd_sfm_fusion.runs as runs, rgbd_sfm_fusion.msg as msg; print(runs.__file__, msg.__name__)'"
expect "wrote .*page.html" "${clean[@]}" bash -c "source '$prefix/setup.bash' && cd '$work' &&
  rosrun rgbd_sfm_fusion render_sequence --count 12 --bag in.bag --truth truth >/dev/null &&
  rosrun rgbd_sfm_fusion fuse_bag in.bag --output fused.bag --results results --report page.html --truth truth"

say "Live"
port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')
live=("${clean[@]}" ROS_MASTER_URI="http://localhost:$port" bash -c)
"${live[@]}" "source '$prefix/setup.bash' && exec roslaunch --port=$port rgbd_sfm_fusion demo.launch rviz:=false" \
  >"$work/roslaunch.log" 2>&1 &
launched=$!
# With --filter, rostopic waits for a master, but not for a topic that nobody has announced yet.
expect "^fused: 0" "${live[@]}" "source '$prefix/setup.bash'
  for i in \$(seq 20); do
    timeout 60 rostopic echo -n 1 --filter 'm.fused > 0.01' /fusion/statistics && exit
    sleep 1
  done"
echo "Installed and used: no complaints."
