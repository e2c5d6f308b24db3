// Makes the .vdb files of tests/library/io/openvdb with OpenVDB itself, so that the reader is tested against its own author.
//
//   g++ -O1 -std=c++17 tools/make_vdb.cpp -o make_vdb -lopenvdb -ltbb -lImath-3_1 && ./make_vdb tests/library/io/openvdb
//
// Needs libopenvdb-dev (made with 10.0.1). The ball has radius 1.25, its middle at (2.3, 2.2, 2.1), voxels of 0.25 and a band of two voxels.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <string>

using namespace openvdb;

template <typename GridType>
typename GridType::Ptr ball() {
    auto grid = tools::createLevelSetSphere<GridType>(1.25f, Vec3f(2.3f, 2.2f, 2.1f), 0.25f, 2.0f);
    grid->setName("surface");
    return grid;
}

template <typename GridType>
void write(const std::string& path, typename GridType::Ptr grid, uint32_t compression) {
    io::File file(path);
    file.setCompression(compression);
    file.write({grid});
    file.close();
}

int main(int, char** argv) {
    initialize();
    const std::string folder = std::string(argv[1]) + "/";
    const uint32_t mask = io::COMPRESS_ACTIVE_MASK;
    write<FloatGrid>(folder + "plain.vdb", ball<FloatGrid>(), io::COMPRESS_NONE);
    write<FloatGrid>(folder + "mask.vdb", ball<FloatGrid>(), mask);
    write<FloatGrid>(folder + "zip.vdb", ball<FloatGrid>(), mask | io::COMPRESS_ZIP);
    write<FloatGrid>(folder + "blosc.vdb", ball<FloatGrid>(), mask | io::COMPRESS_BLOSC);
    auto half = ball<FloatGrid>();
    half->setSaveFloatAsHalf(true);
    write<FloatGrid>(folder + "half.vdb", half, mask | io::COMPRESS_ZIP);
    write<DoubleGrid>(folder + "double.vdb", ball<DoubleGrid>(), mask | io::COMPRESS_ZIP);
    // Inactive values of three kinds, an active tile, a negative corner, an affine map, and another grid before it.
    auto odd = FloatGrid::create(1.5f);
    odd->setName("odd");
    odd->setTransform(math::Transform::createLinearTransform(Mat4R(
        0.5, 0., 0., 0., 0., 0.5, 0., 0., 0., 0., 0.5, 0., 1., 2., 3., 1.)));
    for (int n = 0; n < 8; ++n) odd->tree().setValue(Coord(n - 130, 2 * n, -n), 0.1f * float(n) - 0.35f);
    odd->tree().setValueOff(Coord(-130, 1, 0), -1.5f);
    odd->tree().setValueOff(Coord(-129, 1, 0), 0.25f);
    odd->tree().setValueOff(Coord(-128, 1, 0), 0.5f);
    odd->tree().addTile(1, Coord(16, 0, 0), -1.5f, false);
    odd->tree().addTile(1, Coord(24, 8, 0), 0.75f, true);
    odd->tree().addTile(2, Coord(128, 128, 0), -1.5f, false);
    odd->tree().addTile(3, Coord(-4096, 4096, 0), -1.5f, false);
    auto counts = Int32Grid::create(0);
    counts->setName("counts");
    counts->tree().setValue(Coord(1, 2, 3), 4);
    io::File file(folder + "odd.vdb");
    file.setCompression(mask | io::COMPRESS_ZIP);
    file.write({counts, odd});
    file.close();
}
