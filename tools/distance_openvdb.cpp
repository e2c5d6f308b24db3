// Signed distance by OpenVDB's meshToVolume, timed: the other side of tools/distance_peers.py.
//   distance_openvdb MESH H BAND X Y Z   (the mesh as lines "v x y z" and "f a b c"; H and the origin in its units, BAND in voxels)
// Prints: seconds, voxels within the band. With a seventh argument, values at voxels named on standard input.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <sstream>

int main(int argc, char **argv) {
    openvdb::initialize();
    const double h = std::stod(argv[2]), band = std::stod(argv[3]);
    const openvdb::Vec3d origin(std::stod(argv[4]), std::stod(argv[5]), std::stod(argv[6]));
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::ifstream file(argv[1]);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            openvdb::Vec3d p;
            words >> p[0] >> p[1] >> p[2];
            // Index space, so that single precision is spent on the mesh alone.
            points.push_back(openvdb::Vec3s((p - origin) / h));
        } else if (kind == "f") {
            int a, b, c;
            words >> a >> b >> c;
            triangles.push_back(openvdb::Vec3I(a - 1, b - 1, c - 1));
        }
    }
    const auto start = std::chrono::steady_clock::now();
    const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
        *openvdb::math::Transform::createLinearTransform(1.0), points, triangles, float(band));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::cout << took.count() << " " << grid->activeVoxelCount() << "\n";
    if (argc > 7) {
        const auto accessor = grid->getConstAccessor();
        for (int x, y, z; std::cin >> x >> y >> z;) std::cout << accessor.getValue(openvdb::Coord(x, y, z)) << "\n";
    }
}
