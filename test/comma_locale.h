// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace rgbd_sfm_fusion {

/// As long as it lives, the process writes 1234.5 as 1.234,5. Streams of C++ get a locale that is made here;
/// C's functions get a German one, if the machine has it.
class CommaLocale {
 public:
  CommaLocale() : previous_(std::locale()), previous_c_(std::setlocale(LC_ALL, nullptr)) {
    std::locale::global(std::locale(std::locale::classic(), new Punctuation));
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8"})
      has_c_ = has_c_ || std::setlocale(LC_ALL, name) != nullptr;
  }
  ~CommaLocale() {
    std::locale::global(previous_);
    std::setlocale(LC_ALL, previous_c_.c_str());
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  /// Whether C's functions write a comma, too.
  bool hasC() const { return has_c_; }

 private:
  struct Punctuation : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };

  std::locale previous_;
  std::string previous_c_;
  bool has_c_ = false;
};

}  // namespace rgbd_sfm_fusion
