#include "experiments/atomic_file.hpp"
#include "kernels/name_table.hpp"
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sys/stat.h>
#include <unistd.h>

namespace trigrain {
namespace {

namespace fs = std::filesystem;

struct AtomicFile : testing::Test {
  fs::path folder = fs::path(testing::TempDir()) / ("trigrain_atomic_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  int files() { return static_cast<int>(std::distance(fs::directory_iterator(folder), {})); }
};

TEST_F(AtomicFile, holds_the_text_and_leaves_nothing_beside_it) {
  const std::string text(1 << 20, 'x');
  write_atomically(folder / "a.json", text);
  EXPECT_EQ(text_of(folder / "a.json"), text);
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFile, replaces_what_was_there) {
  write_atomically(folder / "a.json", "a long old text");
  write_atomically(folder / "a.json", "new");
  EXPECT_EQ(text_of(folder / "a.json"), "new");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFile, missing_folder_is_an_input_error_and_is_not_made) {
  EXPECT_THROW(write_atomically(folder / "missing" / "a.json", "text"), InputError);
  EXPECT_EQ(files(), 0);
}

TEST_F(AtomicFile, a_folder_of_that_name_is_an_input_error) {
  fs::create_directory(folder / "a.json");
  EXPECT_THROW(write_atomically(folder / "a.json", "text"), InputError);
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFile, asking_whether_a_file_can_be_written_changes_nothing) {
  write_atomically(folder / "a.json", "text");
  require_writable(folder / "a.json");
  require_writable(folder / "b.json");
  EXPECT_EQ(text_of(folder / "a.json"), "text");
  EXPECT_EQ(files(), 1);
  EXPECT_THROW(require_writable(folder / "missing" / "a.json"), InputError);
}

TEST_F(AtomicFile, a_pipe_takes_the_text_and_stays_a_pipe) {
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  require_writable(pipe);
  write_atomically(pipe, "text");
  char text[8] = {};
  EXPECT_EQ(::read(reader, text, sizeof text), 4);
  EXPECT_STREQ(text, "text");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(files(), 1);
  ::close(reader);
}

TEST_F(AtomicFile, a_place_that_takes_no_files_is_an_input_error) {
  EXPECT_THROW(write_atomically("/proc/a.json", "text"), InputError);
}

} // namespace
} // namespace trigrain
