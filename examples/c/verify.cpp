// Holds a renderer in C++ against splatref, without any library: the planes go to raw files, a TOML
// describes them, the program judges them, and its JSON is read again.
//
//     c++ -std=c++17 examples/c/verify.cpp -o verify && ./verify target/release/splatref
//
// The files go to the folder where it runs. The renderer draws three discs that face the camera,
// first without the low-pass filter, which the verdict names, and then right.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

constexpr int kWidth = 64, kHeight = 48;
constexpr double kCutoff = 2.0, kLowPass = 0.25;  // the defaults of the method ewa

struct Disc {
    double x, y, z, radius;
};

// The camera stands at z = 4 and looks along -z; the picture is 3 world units high.
const std::vector<Disc> kDiscs = {{-0.4, 0.1, 0.0, 0.6}, {0.3, 0.2, 0.5, 0.5}, {0.1, -0.6, -0.5, 0.4}};
constexpr double kEye = 4.0, kScale = kHeight / 3.0;

struct Planes {
    std::vector<float> depth;
    std::vector<uint32_t> id;
};

// The visibility pass: the nearest disc of each pixel. Rows run from the top.
Planes draw(double low_pass) {
    Planes planes{std::vector<float>(kWidth * kHeight, std::numeric_limits<float>::infinity()),
                  std::vector<uint32_t>(kWidth * kHeight, 0xFFFFFFFFu)};
    for (uint32_t i = 0; i < kDiscs.size(); ++i) {
        const Disc& disc = kDiscs[i];
        const float t = static_cast<float>(kEye - disc.z);
        // A disc is a Gaussian of standard deviation radius / cut-off; the filter adds its variance.
        const double deviation = disc.radius / kCutoff * kScale;
        const double variance = deviation * deviation + low_pass;
        const double cx = kWidth / 2.0 + disc.x * kScale, cy = kHeight / 2.0 - disc.y * kScale;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
                const bool inside = (dx * dx + dy * dy) / variance <= kCutoff * kCutoff;
                if (inside && t < planes.depth[y * kWidth + x]) {
                    planes.depth[y * kWidth + x] = t;
                    planes.id[y * kWidth + x] = i;
                }
            }
        }
    }
    return planes;
}

template <class T>
void write_raw(const char* path, const std::vector<T>& values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

void write_scene() {
    std::ofstream ply("discs.ply");
    ply << "ply\nformat ascii 1.0\nelement vertex " << kDiscs.size() << "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"}) ply << "property float " << name << "\n";
    ply << "end_header\n";
    for (const Disc& d : kDiscs) ply << d.x << " " << d.y << " " << d.z << " 0 0 1 " << d.radius << "\n";
    std::ofstream("scene.toml") << "[[model]]\nfile = \"discs.ply\"\n[camera]\nsize = [" << kWidth << ", " << kHeight
                                << "]\neye = [0, 0, " << kEye << "]\ntarget = [0, 0, 0]\northo = 3\n";
    std::ofstream("client.toml") << "[planes]\n\"visibility.Z\" = \"z.raw\"\n\"visibility.id\" = \"id.raw\"\n";
}

// The text of a key of the verdict; empty if it is null.
std::string value_of(const std::string& json, const std::string& key) {
    const std::string before = "\"" + key + "\": \"";
    const size_t at = json.find(before);
    if (at == std::string::npos) return "";
    const size_t start = at + before.size();
    return json.substr(start, json.find('"', start) - start);
}

// Judges what was drawn: the outcome, and the likely mistake.
std::string judge(const std::string& program, const Planes& planes, std::string& mistake) {
    write_raw("z.raw", planes.depth);
    write_raw("id.raw", planes.id);
    std::remove("verdict.json");
    const std::string command = "\"" + program + "\" verify scene.toml client.toml --json verdict.json";
    const int status = std::system(command.c_str());  // 0 if right, 1 if wrong
    std::ifstream file("verdict.json");
    std::stringstream json;
    json << file.rdbuf();
    if (json.str().empty()) {
        std::cerr << "no verdict; the program ended with " << status << "\n";
        std::exit(2);
    }
    mistake = value_of(json.str(), "looks_like");
    return value_of(json.str(), "outcome");
}

int main(int count, char** arguments) {
    const std::string program = count > 1 ? arguments[1] : "splatref";
    write_scene();
    std::string mistake;
    const std::string wrong = judge(program, draw(0.0), mistake);
    std::cout << "\nwithout the filter: " << wrong << ", " << mistake << "\n\n";
    const bool named = wrong == "wrong" && mistake.find("low-pass") != std::string::npos;
    const std::string right = judge(program, draw(kLowPass), mistake);
    std::cout << "\nwith the filter: " << right << "\n";
    return named && right == "right" ? 0 : 1;
}
