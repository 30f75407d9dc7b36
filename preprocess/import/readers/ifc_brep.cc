/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds an IfcAdvancedBrep. IFC has the entities of STEP (ISO 10303-42) under other names, so this code writes them to a STEP
 * file, which Open CASCADE reads and repairs. */
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <Interface_InterfaceModel.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <iomanip>
#include <set>
#include <sstream>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

const char *const names[][2] = { { "IFCADVANCEDBREP", "MANIFOLD_SOLID_BREP" },
                                 { "IFCADVANCEDBREPWITHVOIDS", "BREP_WITH_VOIDS" },
                                 { "IFCADVANCEDFACE", "ADVANCED_FACE" },
                                 { "IFCFACESURFACE", "ADVANCED_FACE" },
                                 { "IFCAXIS1PLACEMENT", "AXIS1_PLACEMENT" },
                                 { "IFCAXIS2PLACEMENT3D", "AXIS2_PLACEMENT_3D" },
                                 { "IFCBSPLINECURVEWITHKNOTS", "B_SPLINE_CURVE_WITH_KNOTS" },
                                 { "IFCBSPLINESURFACEWITHKNOTS", "B_SPLINE_SURFACE_WITH_KNOTS" },
                                 { "IFCCIRCLE", "CIRCLE" },
                                 { "IFCCLOSEDSHELL", "CLOSED_SHELL" },
                                 { "IFCCYLINDRICALSURFACE", "CYLINDRICAL_SURFACE" },
                                 { "IFCEDGECURVE", "EDGE_CURVE" },
                                 { "IFCEDGELOOP", "EDGE_LOOP" },
                                 { "IFCELLIPSE", "ELLIPSE" },
                                 { "IFCFACEBASEDSURFACEMODEL", "SHELL_BASED_SURFACE_MODEL" },
                                 { "IFCFACEBOUND", "FACE_BOUND" },
                                 { "IFCFACEOUTERBOUND", "FACE_OUTER_BOUND" },
                                 { "IFCLINE", "LINE" },
                                 { "IFCOPENSHELL", "OPEN_SHELL" },
                                 { "IFCPLANE", "PLANE" },
                                 { "IFCPOLYLINE", "POLYLINE" },
                                 { "IFCPOLYLOOP", "POLY_LOOP" },
                                 { "IFCSHELLBASEDSURFACEMODEL", "SHELL_BASED_SURFACE_MODEL" },
                                 { "IFCSPHERICALSURFACE", "SPHERICAL_SURFACE" },
                                 { "IFCTOROIDALSURFACE", "TOROIDAL_SURFACE" },
                                 { "IFCTRIMMEDCURVE", "TRIMMED_CURVE" },
                                 { "IFCVECTOR", "VECTOR" },
                                 { "IFCVERTEXPOINT", "VERTEX_POINT" } };

/* Number of statements (#1 to #9) in the fixed head of the STEP file: the IFC file's units, and the schema. IFC statement #ID
 * becomes #(ID+9). */
constexpr int SHIFT = 9;

class step_writer
{
  public:
    explicit step_writer(const ifc_model &of) : in(of)
    {
    }

    std::string whole(int root)
    {
        add(root);
        std::ostringstream head;
        /* STEP requires a decimal point in real numbers, even in whole ones */
        head << std::showpoint << std::setprecision(17);
        head << "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
             << "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
             << "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
             << "#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(" << in.length << "),#1);\n"
             << "#3=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
             << "#4=(CONVERSION_BASED_UNIT('UNIT',#2)LENGTH_UNIT()NAMED_UNIT(#3));\n"
             << "#5=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n#6=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n"
             << "#9=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(" << 1e-3 / in.length << "),#4,'distance_accuracy_value','');\n"
             << "#7=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#9))"
             << "GLOBAL_UNIT_ASSIGNED_CONTEXT((#4,#5,#6))REPRESENTATION_CONTEXT('',''));\n"
             << "#8=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#" << root + SHIFT << "),#7);\n";
        return head.str() + out.str() + "ENDSEC;\nEND-ISO-10303-21;\n";
    }

    size_t faces = 0;

  private:
    const ifc_model &in;
    std::ostringstream out;
    std::set<int> done;
    int made = 0; /* number of STEP statements without a counterpart in the IFC file; they get the ids 2000000000, 1999999999, ... */

    void write(std::ostream &to, const value &from)
    {
        switch (from.kind) {
        case value::ABSENT: to << '$'; break;
        case value::NUMBER: write_number(to, from.number); break;
        case value::TEXT: to << "''"; break;
        case value::NAME: to << from.text; break;
        case value::REFERENCE:
            add(from.id);
            to << '#' << from.id + SHIFT;
            break;
        case value::LIST:
            if (from.text == "IFCPARAMETERVALUE")
                to << "PARAMETER_VALUE";
            to << '(';
            for (size_t i = 0; i < from.list.size(); i++) {
                to << (i > 0 ? "," : "");
                write(to, from.list[i]);
            }
            to << ')';
            break;
        }
    }

    /* Writes a number to the STEP file: without a decimal point if integers are expected (`whole_numbers`), else with one. */
    void write_number(std::ostream &to, double number)
    {
        char text[40];
        snprintf(text, sizeof(text), whole_numbers ? "%.0f" : "%.17G", number);
        std::string digits = text;
        if (!whole_numbers && digits.find('.') == std::string::npos) /* STEP requires a decimal point: turn "1E-05" into "1.E-05" */
            digits.insert(std::min(digits.find('E'), digits.size()), ".");
        to << digits;
    }
    bool whole_numbers = false;

    void write_values(std::ostream &to, const entity &from, size_t first, size_t end, const std::set<size_t> &whole)
    {
        for (size_t i = first; i < end; i++) {
            to << (i > first ? "," : "");
            whole_numbers = whole.count(i) > 0;
            write(to, from[i]);
            whole_numbers = false;
        }
    }

    int add_made(const std::string &statement)
    {
        out << '#' << 2000000000 - made << '=' << statement << ";\n";
        return 2000000000 - made++;
    }

    std::string text_of(const value &from)
    {
        std::ostringstream to;
        write(to, from);
        return to.str();
    }

    /* Returns the reference to the profile curve of a swept surface. Throws `unsupported` if the surface has a placement other than the
     * identity. */
    std::string swept_curve(const entity &surface)
    {
        entity profile = in.statements.get(surface[0]);
        if (profile.type.find("ARBITRARY") == std::string::npos)
            throw unsupported("this IFC shape cannot be built: Plantcast does not support a surface that is swept from " + profile.type);
        if (!surface[1].absent() && placement_of(in, surface[1]).Form() != gp_Identity)
            throw unsupported("this IFC shape cannot be built: Plantcast does not support a position (Position) of a swept surface");
        return text_of(profile[2]);
    }

    std::string statement(const entity &from)
    {
        std::ostringstream to;
        const std::string &type = from.type;
        faces += type == "IFCADVANCEDFACE" || type == "IFCFACESURFACE";
        bool curve = type == "IFCRATIONALBSPLINECURVEWITHKNOTS", plain = type.find("BSPLINECURVE") != std::string::npos;
        const std::set<size_t> whole = plain                                              ? std::set<size_t>{ 0, 5 }
                                       : type.find("BSPLINESURFACE") != std::string::npos ? std::set<size_t>{ 0, 1, 7, 8 }
                                                                                          : std::set<size_t>{};
        if (curve || type == "IFCRATIONALBSPLINESURFACEWITHKNOTS") {
            const char *kind = curve ? "CURVE" : "SURFACE";
            size_t knots = curve ? 5 : 7, weights = curve ? 8 : 12;
            to << "(BOUNDED_" << kind << "()B_SPLINE_" << kind << '(';
            write_values(to, from, 0, knots, whole);
            to << ")B_SPLINE_" << kind << "_WITH_KNOTS(";
            write_values(to, from, knots, weights, whole);
            to << ')' << (curve ? "CURVE()" : "") << "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_" << kind << '(';
            write_values(to, from, weights, weights + 1, whole);
            /* STEP requires the parts of a complex entity to be in alphabetical order */
            to << ")REPRESENTATION_ITEM('')" << (curve ? ")" : "SURFACE())");
            return to.str();
        }
        if (type == "IFCSURFACEOFLINEAREXTRUSION") {
            std::string swept = swept_curve(from), along = text_of(from[2]), depth = text_of(from[3]);
            int vector = add_made("VECTOR(''," + along + ',' + depth + ')');
            return "SURFACE_OF_LINEAR_EXTRUSION(''," + swept + ",#" + std::to_string(vector) + ')';
        }
        if (type == "IFCSURFACEOFREVOLUTION") {
            std::string swept = swept_curve(from);
            return "SURFACE_OF_REVOLUTION(''," + swept + ',' + text_of(from[2]) + ')';
        }
        /* always write three coordinates to the STEP file: IFC may omit the third */
        if (type == "IFCCARTESIANPOINT" || type == "IFCDIRECTION") {
            for (size_t i = 0; i < 3; i++) {
                to << (i > 0 ? "," : "");
                write_number(to, i < from[0].list.size() ? file::number(from[0].list[i]) : 0);
            }
            return (type == "IFCDIRECTION" ? "DIRECTION('',(" : "CARTESIAN_POINT('',(") + to.str() + "))";
        }
        if (type == "IFCAXIS2PLACEMENT2D") {
            std::string origin = text_of(from[0]);
            return "AXIS2_PLACEMENT_3D(''," + origin + ",$," + text_of(from[1]) + ')';
        }
        if (type == "IFCORIENTEDEDGE")
            return "ORIENTED_EDGE('',*,*," + text_of(from[2]) + (from[3].is(".F.") ? ",.F.)" : ",.T.)");
        for (const auto &known : names)
            if (type == known[0]) {
                to << known[1] << "('',";
                write_values(to, from, 0, from.values.size(), whole);
                to << ')';
                return to.str();
            }
        /* 3D curves that also have curves in the parameter space of surfaces (IFCSURFACECURVE, IFCSEAMCURVE) are not converted:
           web-ifc builds the item instead */
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + type);
    }

    void add(int id)
    {
        if (!done.insert(id).second)
            return;
        std::string text = statement(in.statements.get(id));
        out << '#' << id + SHIFT << '=' << text << ";\n";
    }
};

} // namespace

TopoDS_Shape brep_of(const ifc_model &in, const entity &item)
{
    step_writer writer(in);
    std::istringstream text(writer.whole(item.id));
    STEPControl_Reader reader;
    if (reader.ReadStream("brep", text) != IFSelect_RetDone)
        throw unsupported("this IFC shape cannot be built: Open CASCADE could not read its faces");
    Handle(Standard_Transient) root = reader.WS()->Model()->Value(reader.WS()->Model()->NextNumberForLabel("#8"));
    if (!reader.TransferEntity(root) || reader.NbShapes() < 1)
        throw unsupported("this IFC shape cannot be built: Open CASCADE could not build its faces");
    TopoDS_Shape out = reader.OneShape();
    size_t faces = 0;
    for (TopExp_Explorer at(out, TopAbs_FACE); at.More(); at.Next())
        faces++;
    if (faces < writer.faces)
        throw unsupported("this IFC shape cannot be built: only " + std::to_string(faces) + " of its " + std::to_string(writer.faces) +
                          " faces could be built");
    return out;
}

} // namespace ifc
