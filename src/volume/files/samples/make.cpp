// Writes the sample volumes of this folder with OpenVDB and NanoVDB themselves, and what these say they hold to
// golden.txt. Debian: libopenvdb-dev libnanovdb-dev libblosc-dev zlib1g-dev libtbb-dev libboost-dev libboost-iostreams-dev; then
//   g++ -O1 -std=c++17 make.cpp -o make -lopenvdb -ltbb -lImath -lblosc -lz -lboost_iostreams && ./make && gzip -9n *.vdb *.nvdb
//
// Lines of golden.txt: "grid FILE NAME CHANNELS", "map" with the world positions of index (0,0,0), (1,0,0), (0,1,0),
// (0,0,1), "box" of active values, "sum" of all values in that box grown by one (left out where it is huge), and "at"
// with an index and the value there.
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_OPENVDB
#include <openvdb/openvdb.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/Stream.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <fstream>
#include <iomanip>
#include <random>

using namespace openvdb;

std::ofstream golden("golden.txt");

const float* numbers(const float& v, int& n) { n = 1; return &v; }
const float* numbers(const Vec3s& v, int& n) { n = 3; return v.asPointer(); }
void put(float v) { golden << ' ' << v; }
void put(double v) { golden << ' ' << v; }
void put(int v) { golden << ' ' << v; }
void put(const Vec3d& v) { for (int i = 0; i < 3; ++i) put(v[i]); }
void put(const Vec3s& v) { for (int i = 0; i < 3; ++i) put(v[i]); }
void put(const Coord& c) { for (int i = 0; i < 3; ++i) put(c[i]); }

struct Sum {
    Vec3d total{0.0};
    void add(double v) { total += Vec3d(v); }
    template<typename T> void add(const math::Vec3<T>& v) { total += Vec3d(v); }
};

// What a file holds, as told by `world` (index to world) and `at` (index to value).
template<typename World, typename At>
void tell(const std::string& file, const std::string& name, int channels, CoordBBox box, World world, At at,
          const std::vector<Coord>& more)
{
    golden << "grid " << file << ' ' << name << ' ' << channels << "\nmap";
    put(world(Vec3d(0, 0, 0))); put(world(Vec3d(1, 0, 0))); put(world(Vec3d(0, 1, 0))); put(world(Vec3d(0, 0, 1)));
    golden << "\nbox";
    put(box.min()); put(box.max());
    golden << '\n';
    CoordBBox grown = box;
    grown.expand(1);
    if (grown.volume() < 20000000) {
        Sum sum;
        for (auto c = grown.begin(); c; ++c) sum.add(at(*c));
        golden << "sum";
        put(sum.total);
        golden << '\n';
    }
    std::mt19937 random(7);
    auto pick = [&](int low, int high) { return low + int(random() % (uint32_t(high) - uint32_t(low) + 1)); };
    std::vector<Coord> where = more;
    for (int i = 0; i < 12; ++i)
        where.push_back(Coord(pick(grown.min()[0], grown.max()[0]), pick(grown.min()[1], grown.max()[1]),
                              pick(grown.min()[2], grown.max()[2])));
    for (auto& c : where) {
        if (!grown.isInside(c)) continue;
        golden << "at";
        put(c);
        put(at(c));
        golden << '\n';
    }
}

template<typename G> std::vector<Coord> voxels(const G& grid)
{
    std::vector<Coord> found;
    size_t step = std::max<size_t>(1, grid.tree().activeLeafVoxelCount() / 7), n = 0;
    for (auto v = grid.cbeginValueOn(); v; ++v)
        if (n++ % step == 0) {
            CoordBBox box;
            v.getBoundingBox(box);
            found.push_back(box.min());
            found.push_back(box.max());
        }
    return found;
}

template<typename G> void tell(const std::string& file, const std::string& name, const G& grid, int channels)
{
    tell(file, name, channels, grid.evalActiveVoxelBoundingBox(),
         [&](const Vec3d& p) { return grid.indexToWorld(p); },
         [&](const Coord& c) { return grid.tree().getValue(c); }, voxels(grid));
}

// OpenVDB zips no fog volume, so most grids here are of no class.
void write(const std::string& file, const GridPtrVec& grids, uint32_t compression)
{
    io::File out(file);
    out.setCompression(compression);
    out.write(grids);
    out.close();
}

template<typename G> void tell_file(const std::string& file, const std::string& name, int channels)
{
    io::File in(file);
    in.open(false);
    auto grid = gridPtrCast<G>(in.readGrid(name));
    tell(file, name, *grid, channels);
}

template<typename G> typename G::Ptr smoke(const std::string& name, typename G::ValueType background,
                                           typename G::ValueType unit)
{
    auto grid = G::create(background);
    grid->setName(name);
    std::mt19937 random(3);
    auto access = grid->getAccessor();
    for (int i = 0; i < 260; ++i) {
        Coord c(int(random() % 20) - 9, int(random() % 11) + 3, int(random() % 9) + 2);
        access.setValue(c, unit * (float(random() % 4096) / 1024.0f));
    }
    return grid;
}

template<typename B> void nano(const std::string& file, const FloatGrid& grid, nanovdb::io::Codec codec)
{
    auto handle = nanovdb::openToNanoVDB<nanovdb::HostBuffer, FloatTree, B>(grid);
    nanovdb::io::writeGrid(file, handle, codec);
    auto back = nanovdb::io::readGrid(file);
    auto g = back.grid<B>();
    auto b = g->indexBBox();
    tell(file, grid.getName(), 1, CoordBBox(b.min()[0], b.min()[1], b.min()[2], b.max()[0], b.max()[1], b.max()[2]),
         [&](const Vec3d& p) { auto w = g->indexToWorld(nanovdb::Vec3d(p[0], p[1], p[2])); return Vec3d(w[0], w[1], w[2]); },
         [&](const Coord& c) { return float(g->tree().getValue(nanovdb::Coord(c[0], c[1], c[2]))); }, voxels(grid));
}

template<typename N> void nano3(const std::string& file, const nanovdb::NanoGrid<N>* g, const std::string& name, const std::vector<Coord>& more)
{
    auto b = g->indexBBox();
    tell(file, name, 3, CoordBBox(b.min()[0], b.min()[1], b.min()[2], b.max()[0], b.max()[1], b.max()[2]),
         [&](const Vec3d& p) { auto w = g->indexToWorld(nanovdb::Vec3d(p[0], p[1], p[2])); return Vec3d(w[0], w[1], w[2]); },
         [&](const Coord& c) { auto v = g->tree().getValue(nanovdb::Coord(c[0], c[1], c[2])); return Vec3s(v[0], v[1], v[2]); }, more);
}

int main()
{
    initialize();
    golden << std::setprecision(17);
    const uint32_t mask = io::COMPRESS_ACTIVE_MASK, zip = io::COMPRESS_ZIP, blosc = io::COMPRESS_BLOSC;
    for (auto [file, how] : {std::pair{"none", 0u}, {"mask", mask}, {"zip", zip}, {"zip_mask", zip | mask}, {"blosc", blosc}, {"blosc_mask", blosc | mask}})
        for (bool half : {false, true}) {
            auto density = smoke<FloatGrid>("density", 0.0f, 1.0f);
            density->setSaveFloatAsHalf(half);
            density->setTransform(math::Transform::createLinearTransform(0.125));
            std::string name = std::string(file) + (half ? "_half.vdb" : ".vdb");
            write(name, {density}, how);
            tell_file<FloatGrid>(name, "density", 1);
        }
    { // Noise in all of many leaves: values that do not compress, and more than one leaf dense.
        auto density = FloatGrid::create();
        density->setName("density");
        density->setGridClass(GRID_FOG_VOLUME);
        std::mt19937 random(5);
        for (auto c = CoordBBox(-8, 0, 0, 7, 7, 15).begin(); c; ++c) density->tree().setValue(*c, float(random()) / 4e9f);
        density->setTransform(std::make_shared<math::Transform>(
            math::MapBase::Ptr(new math::ScaleTranslateMap(Vec3d(0.5, 0.25, 2.0), Vec3d(10, -20, 30)))));
        write("dense.vdb", {density}, blosc | mask);
        tell_file<FloatGrid>("dense.vdb", "density", 1);
        density->setSaveFloatAsHalf(true);
        write("dense_half.vdb", {density}, blosc | mask);
        tell_file<FloatGrid>("dense_half.vdb", "density", 1);
    }
    { // Background, tiles of every size, inactive values of every kind, an affine map.
        auto grid = FloatGrid::create(0.25f);
        grid->setName("smoke");
        auto& tree = grid->tree();
        tree.addTile(1, Coord(8, 0, 0), 0.5f, true);
        tree.addTile(1, Coord(-8, 0, 0), 0.75f, false);
        tree.addTile(2, Coord(128, 0, 0), 2.0f, true);
        tree.addTile(2, Coord(0, 128, 0), 3.0f, false);
        auto leaf = [&](int at, std::vector<float> inactive) {
            Coord origin(0, 0, at * 8);
            for (int i = 0; i < 40; ++i) tree.setValue(origin + Coord(i % 8, i / 8, 1), float(i));
            tree.touchLeaf(origin);
            for (int i = 0; i < 512 - 0; ++i) {
                Coord c = origin + Coord(i / 64, i / 8 % 8, i % 8);
                if (!tree.isValueOn(c)) tree.setValueOff(c, inactive[size_t(i) % inactive.size()]);
            }
        };
        leaf(0, {0.25f});
        leaf(1, {-0.25f});
        leaf(2, {7.0f});
        leaf(3, {0.25f, -0.25f});
        leaf(4, {0.25f, 7.0f});
        leaf(5, {8.0f, 7.0f});
        leaf(6, {8.0f, 7.0f, 6.0f});
        math::Mat4d m(1., 0.1, 0., 0., 0., 2., 0.3, 0., 0.25, 0., 0.5, 0., 5., -6., 7., 1.);
        grid->setTransform(math::Transform::createLinearTransform(m));
        for (auto [file, how] : {std::pair{"tiles", zip | mask}, {"tiles_blosc", blosc | mask}, {"tiles_none", 0u}}) {
            write(std::string(file) + ".vdb", {grid}, how);
            tell_file<FloatGrid>(std::string(file) + ".vdb", "smoke", 1);
        }
        grid->setSaveFloatAsHalf(true);
        write("tiles_half.vdb", {grid}, zip | mask);
        tell_file<FloatGrid>("tiles_half.vdb", "smoke", 1);
        grid->setSaveFloatAsHalf(false);
        nano<float>("tiles.nvdb", *grid, nanovdb::io::Codec::ZIP);
    }
    { // Values too far apart for anything but sparse storage.
        auto grid = FloatGrid::create();
        grid->setName("density");
        grid->tree().addTile(3, Coord(-4096, 0, 4096), 1.5f, true);
        grid->tree().addTile(3, Coord(8192, 0, 0), 4.0f, false);
        grid->tree().setValue(Coord(100000, -100000, 5), 2.5f);
        grid->setTransform(std::make_shared<math::Transform>(math::MapBase::Ptr(new math::TranslationMap(Vec3d(1, 2, 3)))));
        write("far.vdb", {grid}, blosc | mask);
        tell_file<FloatGrid>("far.vdb", "density", 1);
        nano<float>("far.nvdb", *grid, nanovdb::io::Codec::ZIP);
    }
    { // Several grids of several types, one of them twice, one sharing the tree of another.
        auto color = smoke<Vec3SGrid>("Cd", Vec3s(0.0f), Vec3s(0.25f, 1.0f, 2.0f));
        auto half = smoke<Vec3SGrid>("color", Vec3s(0.5f, 0.25f, 0.0f), Vec3s(1.0f, 0.5f, 0.1f));
        half->setSaveFloatAsHalf(true);
        auto double3 = smoke<Vec3DGrid>("wide", Vec3d(0.0), Vec3d(0.3, 0.2, 0.1));
        auto heat = DoubleGrid::create(300.0);
        heat->setName("temperature");
        heat->tree().setValue(Coord(3, 4, 5), 1500.1);
        heat->setTransform(math::Transform::createLinearTransform(0.5));
        auto again = heat->copy();
        again->setName("cooler");
        again->setTransform(math::Transform::createLinearTransform(2.0));
        auto first = smoke<FloatGrid>("flame", 0.0f, 1.0f), second = smoke<FloatGrid>("flame", 0.0f, 2.0f);
        auto ids = Int32Grid::create(); ids->setName("ids"); ids->tree().setValue(Coord(0), 3);
        auto inside = BoolGrid::create(); inside->setName("inside"); inside->tree().setValue(Coord(0), true);
        write("several.vdb", {color, half, double3, heat, again, first, second, ids, inside}, blosc | mask);
        tell_file<Vec3SGrid>("several.vdb", "Cd", 3);
        tell_file<Vec3SGrid>("several.vdb", "color", 3);
        tell_file<Vec3DGrid>("several.vdb", "wide", 3);
        tell_file<DoubleGrid>("several.vdb", "temperature", 1);
        tell_file<DoubleGrid>("several.vdb", "cooler", 1);
        tell_file<FloatGrid>("several.vdb", "flame[0]", 1);
        tell_file<FloatGrid>("several.vdb", "flame[1]", 1);
        std::vector<nanovdb::GridHandle<>> handles;
        handles.push_back(nanovdb::openToNanoVDB(color));
        handles.push_back(nanovdb::openToNanoVDB(ids));
        nanovdb::io::writeGrids("several.nvdb", handles, nanovdb::io::Codec::BLOSC);
        nano3<nanovdb::Vec3f>("several.nvdb", handles[0].grid<nanovdb::Vec3f>(), "Cd", voxels(*color));
    }
    { // What cannot be a density.
        auto sphere = tools::createLevelSetSphere<FloatGrid>(3.0f, Vec3f(0.0f), 1.0f);
        sphere->setName("surface");
        write("levelset.vdb", {sphere}, zip | mask);
        auto handle = nanovdb::openToNanoVDB(sphere);
        nanovdb::io::writeGrid("levelset.nvdb", handle, nanovdb::io::Codec::ZIP);
        auto bent = smoke<FloatGrid>("density", 0.0f, 1.0f);
        bent->setTransform(math::Transform::createFrustumTransform(BBoxd(Vec3d(0), Vec3d(10)), 0.5, 10.0));
        write("frustum.vdb", {bent}, zip | mask);
        auto empty = FloatGrid::create();
        empty->setName("density");
        write("empty.vdb", {empty}, blosc | mask);
        auto fog = FloatGrid::create(0.5f);
        fog->setName("density");
        write("everywhere.vdb", {fog}, blosc | mask);
        std::ofstream stream("stream.vdb", std::ios::binary);
        io::Stream(stream).write(GridPtrVec{smoke<FloatGrid>("density", 0.0f, 1.0f)});
    }
    {
        auto density = smoke<FloatGrid>("density", 0.0f, 1.0f);
        density->setTransform(math::Transform::createLinearTransform(0.125));
        nano<float>("none.nvdb", *density, nanovdb::io::Codec::NONE);
        nano<float>("zip.nvdb", *density, nanovdb::io::Codec::ZIP);
        nano<float>("blosc.nvdb", *density, nanovdb::io::Codec::BLOSC);
        nano<nanovdb::Fp4>("fp4.nvdb", *density, nanovdb::io::Codec::ZIP);
        nano<nanovdb::Fp8>("fp8.nvdb", *density, nanovdb::io::Codec::ZIP);
        nano<nanovdb::Fp16>("fp16.nvdb", *density, nanovdb::io::Codec::ZIP);
        nano<nanovdb::FpN>("fpn.nvdb", *density, nanovdb::io::Codec::ZIP);
    }
}
