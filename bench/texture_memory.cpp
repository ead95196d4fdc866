// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds of a frame whose textures do not fit: granita_texture_memory [MiB of textures] [MiB of
// memory] [side].
//
// The same look-ups with room for everything and with the memory given, in turn, three times each:
// 4096 buckets, each 256 points at one texel a pixel in windows of two images, all of them strewn
// over all images, which are decoded one by one though they share sixteen files.  Decoding is part
// of it.  Fails where what is limited takes more than three times as long, in the median, or gets
// other numbers.  The defaults are a sixteenth of 8 GiB through 512 MiB;
// `2560 1024 8192` is a few images of 8192 x 8192.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include "shade/textures/texture_filter.h"
#include "shade/textures/tiled_image.h"

namespace {

using namespace granita;

constexpr int kBuckets = 4096, kPoints = 16;  // a side of a bucket
constexpr double kMostTimes = 3.0;            // as long as with room for all
constexpr int kFiles = 16;                    // different ones: writing them is not the trial

/// Noise: what a file of it takes, and how long decoding does, is that of a photograph at least.
bool write_noise(const std::string& path, int side, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> texels(static_cast<std::size_t>(side) * side * 4);
    for (auto& t : texels) t = static_cast<std::uint8_t>(128 + random() % 32);
    const auto out = OIIO::ImageOutput::create(path);
    OIIO::ImageSpec spec(side, side, 4, OIIO::TypeUInt8);
    spec.attribute("png:compressionLevel", 1);
    return out && out->open(path, spec) && out->write_image(OIIO::TypeUInt8, texels.data()) &&
           out->close();
}

double frame(const std::vector<Image>& files, std::uint64_t memory, double& sum,
             std::uint64_t& held) {
    Report report;
    const auto cache = std::make_shared<TileCache>(memory, report);
    const auto open_files = std::make_shared<OpenFiles>(64);
    const auto begin = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<TiledImage>> images;
    for (const Image& file : files)
        images.push_back(std::make_unique<TiledImage>(file, read_texture_header(file), false, cache,
                                                      open_files));
    std::vector<double> sums(kBuckets);
    std::atomic<int> next{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t)
        threads.emplace_back([&] {
            for (int bucket = next++; bucket < kBuckets; bucket = next++) {
                std::mt19937 random(static_cast<unsigned>(bucket));
                for (int k = 0; k < 2; ++k) {
                    TiledImage& image = *images[random() % images.size()];
                    const Vec2f corner(float(random() % 1024) / 1024.0f,
                                       float(random() % 1024) / 1024.0f);
                    if (!image.make_ready()) std::abort();
                    const float texel = 1.0f / static_cast<float>(image.header().width);
                    const TileCache::ReadScope scope(*cache);
                    for (int i = 0; i < kPoints * kPoints; ++i) {
                        const Vec2f at = corner + Vec2f(i % kPoints, i / kPoints) * texel;
                        sums[bucket] += filtered(image, {}, {at, {texel, 0}, {0, texel}}).x;
                    }
                }
            }
        });
    for (auto& thread : threads) thread.join();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    sum = 0.0;
    for (const double s : sums) sum += s;
    held = cache->byte_count();
    return seconds.count();
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, int usual) { return argc > i ? std::atoi(argv[i]) : usual; };
    const int textures = number(1, 512), memory = number(2, 32), side = number(3, 2048);
    const int count =
        std::max(1, static_cast<int>((std::int64_t{textures} << 20) / (4ll * side * side)));
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("granita-textures-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::vector<Image> files(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const int file = i % kFiles;
        files[i].name = std::to_string(i);
        files[i].path = (folder / (std::to_string(file) + ".png")).string();
        if (i == file && !write_noise(files[i].path, side, static_cast<unsigned>(i))) return 1;
    }
    std::printf("%d images of %d x %d, %d MiB decoded, through %d MiB\n", count, side, side,
                textures, memory);
    double times[3], same[2];
    std::uint64_t held[2];
    for (int k = 0; k < 3; ++k) {
        const double room = frame(files, UINT64_MAX, same[0], held[0]);
        const double tight = frame(files, std::uint64_t(memory) << 20, same[1], held[1]);
        times[k] = tight / room;
        std::printf("all in memory %.2f s (%.0f MiB), limited %.2f s (%.0f MiB): %.2f times; %s\n",
                    room, held[0] / 1048576.0, tight, held[1] / 1048576.0, times[k],
                    same[0] == same[1] ? "the same numbers" : "OTHER NUMBERS");
        std::fflush(stdout);
    }
    std::filesystem::remove_all(folder);
    std::sort(times, times + 3);
    return same[0] != same[1] || times[1] > kMostTimes;
}
