// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/fingerprint.hpp"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& file, std::streamoff at, char byte) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(at);
  stream.put(byte);
}

TEST(Fingerprint, TellsFilesApartByContentAndSizeAndNotByName) {
  const test::TemporaryFolder folder;
  const fs::path a = folder.write("a", "one recording");
  const fs::path b = folder.write("b", "one recording");
  EXPECT_EQ(fingerprint(a).hash, fingerprint(b).hash);
  EXPECT_EQ(fingerprint(a).bytes, 13U);
  EXPECT_EQ(fingerprint(a).hash.size(), 32U);
  put(b, 5, 'X');
  EXPECT_NE(fingerprint(a).hash, fingerprint(b).hash);
  EXPECT_NE(fingerprint(folder.write("c", "one recordin")).hash, fingerprint(a).hash);
  EXPECT_THROW(static_cast<void>(fingerprint(folder / "none")), InputError);
}

TEST(Fingerprint, OfALargeFileReadsBothEndsAndPlacesBetween) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("large", "");
  fs::resize_file(file, uint64_t{1} << 30U);  // a hole
  const std::string before = fingerprint(file).hash;
  for (const std::streamoff at : {std::streamoff{0}, (std::streamoff{1} << 30) - 1}) {
    put(file, at, 'X');
    EXPECT_NE(fingerprint(file).hash, before);
    put(file, at, '\0');
    EXPECT_EQ(fingerprint(file).hash, before);
  }
}

TEST(Fingerprint, OfAFolderKnowsNamesLinkedFoldersAndWhatCannotBeRead) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder elsewhere;
  elsewhere.write("000000.bin", "first");
  folder.write("times.txt", "0.0");
  fs::create_directory_symlink(elsewhere.path(), folder / "velodyne");
  const Fingerprint before = fingerprint(folder.path());
  EXPECT_EQ(before.bytes, 8U);
  put(elsewhere / "000000.bin", 0, 'F');
  EXPECT_NE(fingerprint(folder.path()).hash, before.hash);
  put(elsewhere / "000000.bin", 0, 'f');
  EXPECT_EQ(fingerprint(folder.path()).hash, before.hash);
  fs::rename(elsewhere / "000000.bin", elsewhere / "000001.bin");
  EXPECT_NE(fingerprint(folder.path()).hash, before.hash);
  fs::create_directory_symlink(folder.path(), folder / "round");  // leads round and round
  EXPECT_EQ(fingerprint(folder.path()).hash, fingerprint(folder.path()).hash);
}

}  // namespace
}  // namespace adit
