// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged images of every format that is read, by the hundred thousands: granita_damaged_images
// [COUNT of each kind] [SUFFIX, .png say: only of this format] [FIRST: the number of the first].
// A disk takes longer than decoding does: TMPDIR=/dev/shm.
//
// Each is opened, decoded and looked at in a process of its own kind, which a fault would end; what
// ended any is printed and kept, and the exit code is 1.  Tests run a few of each
// (tests/native/shade/textures).
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "native/shade/textures/image_mutations.h"
#include "shade/textures/texture_filter.h"
#include "shade/textures/tiled_image.h"

namespace {

using namespace granita;
using Bytes = std::vector<std::uint8_t>;

/// More of either than a small damaged image may take.
constexpr unsigned kMostSeconds = 60;
constexpr rlim_t kMostMemory = rlim_t{8} << 30;
/// Pictures whose header asks for more are counted, not decoded: their time says nothing.
constexpr std::int64_t kDecodedTexels = 1 << 22;

enum Outcome { Picture, Refused, Large, OutcomeCount };

struct Shared {
    volatile int current;
    int outcomes[OutcomeCount];
};

Outcome look_at(const std::string& path) {
    Image image;
    image.name = "damaged";
    image.path = path;
    const TextureHeader header = read_texture_header(image);
    if (!header.error.empty()) return Refused;
    if (std::int64_t{header.width} * header.height > kDecodedTexels) return Large;
    Report report;
    const auto cache = std::make_shared<TileCache>(64u << 20, report);
    TiledImage tiled(image, header, false, cache, std::make_shared<OpenFiles>(4));
    if (!tiled.make_ready()) return Refused;
    const TileCache::ReadScope scope(*cache);
    for (const float size : {0.0f, 0.1f, 1.0f})
        (void)filtered(tiled, {}, {{0.4f, 0.6f}, {size, 0.0f}, {0.0f, size}});
    return Picture;
}

Bytes mutation(const Bytes& seed, int number) {
    std::mt19937 random(static_cast<unsigned>(number));
    return mutated(seed, random);
}

void write(const std::string& path, const Bytes& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

void run(const Bytes& seed, const std::string& path, int first, int end, Shared& shared) {
#if !defined(__SANITIZE_ADDRESS__)  // whose shadow memory alone is more; it has a limit of its own
    const rlimit limit{kMostMemory, kMostMemory};
    setrlimit(RLIMIT_AS, &limit);
#endif
    if (!std::freopen("/dev/null", "w", stderr)) std::_Exit(2);
    for (int number = first; number < end; ++number) {
        shared.current = number;
        alarm(kMostSeconds);
        write(path, mutation(seed, number));
        ++shared.outcomes[look_at(path)];
    }
    std::_Exit(0);
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
/// What readers keep until the process ends is no fault.
extern "C" __attribute__((visibility("default"))) const char* __asan_default_options() {
    return "detect_leaks=0:hard_rss_limit_mb=8192";
}
#endif

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 5000;
    const std::string wanted = argc > 2 ? argv[2] : "";
    const int begin_at = argc > 3 ? std::atoi(argv[3]) : 0;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("granita-damaged-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    int faults = 0;
    for (const SeedFormat& format : kSeedFormats) {
        if (!wanted.empty() && wanted != format.suffix) continue;
        const std::string path = (folder / "seed").string() + format.suffix;
        // In a process of its own as well: readers' and writers' threads do not outlive a fork.
        const pid_t writer = fork();
        if (writer == 0) std::_Exit(write_seed(format, path) ? 0 : 1);
        int written = 0;
        if (writer < 0 || waitpid(writer, &written, 0) < 0) return 2;
        if (written != 0) {
            std::printf("%s: no seed can be written\n", format.suffix);
            continue;
        }
        std::ifstream file(path, std::ios::binary);
        const Bytes seed{std::istreambuf_iterator<char>(file), {}};
        auto& shared = *static_cast<Shared*>(mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE,
                                                  MAP_SHARED | MAP_ANONYMOUS, -1, 0));
        const auto begin = std::chrono::steady_clock::now();
        shared.current = begin_at - 1;
        for (int first = begin_at; first < begin_at + count; first = shared.current + 1) {
            const pid_t child = fork();
            if (child == 0) run(seed, path, first, begin_at + count, shared);
            int status = 0;
            if (child < 0 || waitpid(child, &status, 0) < 0) return 2;
            if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
            if (shared.current < first) return 2;  // ended before it began with any
            const std::string kept = "damaged-" + std::to_string(++faults) + format.suffix;
            write(kept, mutation(seed, shared.current));
            std::printf("%s, mutation %d: signal %d, kept as %s\n", format.suffix,
                        int(shared.current), WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                        kept.c_str());
        }
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        std::printf(
            "%-5s %-5s %6d mutations: %6d pictures, %6d refused, %4d too large to tell, %.0f s\n",
            format.suffix, format.compression, count, shared.outcomes[Picture],
            shared.outcomes[Refused], shared.outcomes[Large], seconds.count());
        std::fflush(stdout);
        munmap(&shared, sizeof(Shared));
    }
    std::filesystem::remove_all(folder);
    std::printf("%d faults\n", faults);
    return faults > 0;
}
