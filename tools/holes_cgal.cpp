// Holes closed by CGAL's triangulate_refine_and_fair_hole: one of the peers of tools/holes.py.
//   holes_cgal IN OUT   (meshes as lines "v x y z" and "f a b c")
// Prints the seconds that all holes took together.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace PMP = CGAL::Polygon_mesh_processing;

int main(int, char **argv) {
    Mesh mesh;
    std::ifstream file(argv[1]);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            double x, y, z;
            words >> x >> y >> z;
            mesh.add_vertex(Kernel::Point_3(x, y, z));
        } else if (kind == "f") {
            unsigned a, b, c;
            words >> a >> b >> c;
            mesh.add_face(Mesh::Vertex_index(a - 1), Mesh::Vertex_index(b - 1), Mesh::Vertex_index(c - 1));
        }
    }
    const auto start = std::chrono::steady_clock::now();
    std::vector<Mesh::Halfedge_index> rims;
    PMP::extract_boundary_cycles(mesh, std::back_inserter(rims));
    for (auto rim : rims) {
        std::vector<Mesh::Face_index> faces;
        std::vector<Mesh::Vertex_index> vertices;
        PMP::triangulate_refine_and_fair_hole(mesh, rim, std::back_inserter(faces), std::back_inserter(vertices));
    }
    std::cout << std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() << "\n";
    std::ofstream out(argv[2]);
    out.precision(17);
    for (auto v : mesh.vertices()) {
        out << "v " << mesh.point(v) << "\n";
    }
    for (auto f : mesh.faces()) {
        out << "f";
        for (auto v : vertices_around_face(mesh.halfedge(f), mesh)) {
            out << " " << v.idx() + 1;
        }
        out << "\n";
    }
}
