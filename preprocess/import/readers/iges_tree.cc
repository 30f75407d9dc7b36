/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Follows the entities of an IGES file from the roots down, in parallel with the shapes that Open CASCADE made from them. */
#include "preprocess/import/readers/iges_tree.hh"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <IGESBasic_Group.hxx>
#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESCAFControl.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_LevelListEntity.hxx>
#include <IGESGraph_Color.hxx>
#include <IGESSolid_SolidAssembly.hxx>
#include <Quantity_Color.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Shape.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp_Trsf.hxx>
#include <gp_Vec.hxx>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "preprocess/import/readers/reader.hh"

namespace
{

using entity = Handle(IGESData_IGESEntity);

struct iges_tree {
    Handle(XCAFDoc_ShapeTool) shapes;
    Handle(XCAFDoc_ColorTool) colors;
    Handle(XCAFDoc_LayerTool) layers;
    const struct text_encoding *encoding;
    Handle(Transfer_TransientProcess) process; /* Open CASCADE's map from an IGES entity to the shape made from it */
    double unit_mm;
    std::map<const Standard_Transient *, TDF_Label> made;
};

/* --- entities ---------------------------------------------------------------------------------------------------------------------- */

std::string trimmed(const Handle(TCollection_HAsciiString) & text)
{
    std::string out = text.IsNull() ? "" : text->ToCString();
    out.erase(0, out.find_first_not_of(' '));
    out.erase(out.find_last_not_of(' ') + 1);
    return out;
}

std::string name_of(const entity &from)
{
    if (from.IsNull())
        return "";
    Handle(IGESBasic_SubfigureDef) figure = Handle(IGESBasic_SubfigureDef)::DownCast(from);
    std::string own = figure.IsNull() ? "" : trimmed(figure->Name());
    return own.empty() && from->HasName() ? trimmed(from->NameValue()) : own;
}

bool color_of(const entity &from, Quantity_Color *out)
{
    Standard_Real part[3];
    if (from.IsNull() || (from->DefColor() != IGESData_DefValue && from->DefColor() != IGESData_DefReference))
        return false;
    if (from->DefColor() == IGESData_DefValue) {
        *out = IGESCAFControl::DecodeColor(from->RankColor());
        return true;
    }
    Handle(IGESGraph_Color) color = Handle(IGESGraph_Color)::DownCast(from->Color());
    if (color.IsNull())
        return false;
    color->RGBIntensity(part[0], part[1], part[2]); /* the colour's components are percentages */
    for (Standard_Real &each : part)
        each = std::isfinite(each) ? std::clamp(each / 100, 0.0, 1.0) : 0;
    out->SetValues(part[0], part[1], part[2], Quantity_TOC_sRGB);
    return true;
}

std::string layer_of(const entity &from)
{
    if (from.IsNull() || from->DefLevel() == IGESData_DefNone)
        return "";
    Handle(IGESData_LevelListEntity) list = from->LevelList();
    if (list.IsNull())
        return from->Level() > 0 ? std::to_string(from->Level()) : "";
    std::string out;
    for (int i = 1; i <= list->NbLevelNumbers(); i++)
        out += (i > 1 ? ", " : "") + std::to_string(list->LevelNumber(i));
    return out;
}

/* Returns the members of an IGES group, in file order. */
std::vector<entity> members_of(const entity &from)
{
    std::vector<entity> out;
    Handle(IGESBasic_Group) group = Handle(IGESBasic_Group)::DownCast(from);
    Handle(IGESBasic_SubfigureDef) figure = Handle(IGESBasic_SubfigureDef)::DownCast(from);
    Handle(IGESSolid_SolidAssembly) solids = Handle(IGESSolid_SolidAssembly)::DownCast(from);
    for (int i = 1; !group.IsNull() && i <= group->NbEntities(); i++)
        out.push_back(group->Entity(i));
    for (int i = 1; !figure.IsNull() && i <= figure->NbEntities(); i++)
        out.push_back(figure->AssociatedEntity(i));
    for (int i = 1; !solids.IsNull() && i <= solids->NbItems(); i++)
        out.push_back(solids->Item(i));
    return out;
}

/* If the entity is an instance of an IGES subfigure, returns the subfigure's definition; otherwise the entity itself. */
entity product_of(const entity &from)
{
    Handle(IGESBasic_SingularSubfigure) place = Handle(IGESBasic_SingularSubfigure)::DownCast(from);
    return place.IsNull() ? from : entity(place->Subfigure());
}

bool is_group(const entity &from)
{
    return from->IsKind(STANDARD_TYPE(IGESBasic_Group)) || from->IsKind(STANDARD_TYPE(IGESBasic_SubfigureDef)) ||
           from->IsKind(STANDARD_TYPE(IGESSolid_SolidAssembly));
}

double scale_of(const entity &from)
{
    Handle(IGESBasic_SingularSubfigure) place = Handle(IGESBasic_SingularSubfigure)::DownCast(from);
    return place.IsNull() || !place->HasScaleFactor() || !(place->ScaleFactor() > 0) ? 1 : place->ScaleFactor();
}

TopoDS_Shape shape_of(const iges_tree &t, const entity &from)
{
    Handle(Transfer_Binder) binder = from.IsNull() ? Handle(Transfer_Binder)() : t.process->Find(from);
    return binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder);
}

/* an IGES entity and its Open CASCADE shape, which includes the entity's placement */
struct iges_item {
    entity from;
    TopoDS_Shape shape;
};

/* Returns the members of a group with their shapes, leaving out members without one. The shapes come from the group's own
 * shape, because the shape recorded for a single surface may lack its placement. The group's shape does not contain scaled
 * instances, so these use the shape of their definition. */
std::vector<iges_item> items_of(const iges_tree &t, const iges_item &group)
{
    std::vector<iges_item> out;
    std::vector<TopoDS_Shape> shapes;
    for (TopoDS_Iterator child(group.shape, Standard_False, Standard_False); child.More(); child.Next())
        shapes.push_back(child.Value());
    size_t found = 0, count = 0;
    for (const entity &each : members_of(group.from))
        count += !shape_of(t, each).IsNull();
    for (const entity &each : members_of(group.from))
        if (!shape_of(t, each).IsNull())
            out.push_back({ each, count == shapes.size() ? shapes[found++] : shape_of(t, each) });
        else if (!each.IsNull() && scale_of(each) != 1 && !shape_of(t, product_of(each)).IsNull())
            out.push_back({ each, shape_of(t, product_of(each)) });
    return out;
}

/* --- labels ------------------------------------------------------------------------------------------------------------------------- */

void describe_layer(const iges_tree &t, const TDF_Label &label, const std::string &layer)
{
    if (!layer.empty())
        t.layers->SetLayer(label, TCollection_ExtendedString(t.encoding->utf8(layer).c_str(), Standard_True));
}

/* Copies the name, colour and layer of an IGES entity to a label of the XCAF document. If the entity lacks one of these, the
 * label keeps its own. */
void describe(const iges_tree &t, const TDF_Label &label, const entity &from)
{
    Quantity_Color color;
    std::string name = name_of(from);
    if (!name.empty())
        TDataStd_Name::Set(label, TCollection_ExtendedString(t.encoding->utf8(name).c_str(), Standard_True));
    if (color_of(from, &color))
        t.colors->SetColor(label, color, XCAFDoc_ColorSurf);
    describe_layer(t, label, layer_of(from));
}

bool has_faces(const TopoDS_Shape &shape)
{
    return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
}

enum class shape_kind { nothing, surface, part };

/* Returns how an IGES entity becomes a part of the model. A loose surface is joined with the other loose surfaces of its group;
 * a solid or a group becomes a separate part. */
shape_kind kind_of(const iges_item &what)
{
    if (!has_faces(what.shape))
        return shape_kind::nothing;
    return is_group(product_of(what.from)) || what.shape.ShapeType() <= TopAbs_SOLID ? shape_kind::part : shape_kind::surface;
}

TDF_Label add_surfaces(const iges_tree &t, const std::vector<iges_item> &surfaces)
{
    BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (const iges_item &each : surfaces)
        builder.Add(all, each.shape);
    ShapeFix_Shape fix(all);
    fix.Perform();
    TDF_Label label = t.shapes->AddShape(fix.Shape(), Standard_False, Standard_False);
    TDataStd_Name::Set(label, TCollection_ExtendedString());
    for (const iges_item &each : surfaces) {
        Quantity_Color color;
        TDF_Label side;
        if (color_of(each.from, &color) && t.shapes->AddSubShape(label, fix.Context()->Apply(each.shape), side))
            t.colors->SetColor(side, color, XCAFDoc_ColorSurf);
    }
    return label;
}

/* Groups loose surfaces by layer; the surfaces of each layer become one part. */
std::map<std::string, std::vector<iges_item>> by_layer(const std::vector<iges_item> &loose)
{
    std::map<std::string, std::vector<iges_item>> out;
    for (const iges_item &each : loose)
        out[layer_of(each.from)].push_back(each);
    return out;
}

TDF_Label add_whole(const iges_tree &t, const TopoDS_Shape &shape)
{
    ShapeFix_Shape fix(shape);
    fix.Perform();
    TDF_Label label = t.shapes->AddShape(fix.Shape(), Standard_False, Standard_False);
    TDataStd_Name::Set(label, TCollection_ExtendedString());
    return label;
}

TDF_Label label_of(iges_tree *t, const iges_item &what, int depth);

/* Adds a scaled instance as a separate part with scaled geometry, because a placement in XCAF cannot scale. */
TDF_Label add_scaled(iges_tree *t, const iges_item &what)
{
    gp_Trsf larger;
    larger.SetScaleFactor(scale_of(what.from));
    return add_whole(*t, BRepBuilderAPI_Transform(what.shape, larger, Standard_True).Shape());
}

void add_component(iges_tree *t, const TDF_Label &to, const iges_item &what, int depth)
{
    const entity product = product_of(what.from);
    bool scaled = scale_of(what.from) != 1;
    TopLoc_Location place = what.shape.Location();
    if (scaled) {
        gp_Trsf moved;
        moved.SetTranslation(gp_Vec(Handle(IGESBasic_SingularSubfigure)::DownCast(what.from)->Translation() * t->unit_mm));
        place = TopLoc_Location(moved);
    }
    TDF_Label of = scaled ? add_scaled(t, what) : label_of(t, { product, what.shape }, depth);
    if (scaled)
        describe(*t, of, product);
    TDF_Label component = t->shapes->AddComponent(to, of, place);
    if (product != what.from)
        describe(*t, component, what.from);
}

/* Skips groups that only wrap one part: while a group has just one part, without name and placement, descends into that part.
 * Returns the part or group reached. */
iges_item without_wrappings(const iges_tree &t, iges_item what)
{
    for (int depth = 0; depth < MAX_DEPTH && is_group(what.from); depth++) {
        std::vector<iges_item> items = items_of(t, what);
        if (items.size() != 1 || kind_of(items[0]) != shape_kind::part || product_of(items[0].from) != items[0].from ||
            !name_of(items[0].from).empty() || !items[0].shape.Location().IsIdentity())
            break;
        what = items[0];
    }
    return what;
}

TDF_Label add_group(iges_tree *t, const iges_item &group, int depth)
{
    std::vector<iges_item> parts, loose;
    for (const iges_item &each : items_of(*t, group))
        switch (kind_of(each)) {
        case shape_kind::part: parts.push_back(each); break;
        case shape_kind::surface: loose.push_back(each); break;
        case shape_kind::nothing: break;
        }
    if (parts.empty())
        return add_surfaces(*t, loose);
    TDF_Label label = t->shapes->NewShape();
    TDataStd_Name::Set(label, TCollection_ExtendedString());
    for (const iges_item &each : parts)
        add_component(t, label, each, depth + 1);
    for (const auto &entry : by_layer(loose)) {
        TDF_Label part = add_surfaces(*t, entry.second);
        describe_layer(*t, part, entry.first);
        t->shapes->AddComponent(label, part, TopLoc_Location());
    }
    return label;
}

/* Returns the XCAF label of a part's shape without placement, which all instances of the part share. Creates the label on the
 * first call. */
TDF_Label label_of(iges_tree *t, const iges_item &what, int depth)
{
    if (depth > MAX_DEPTH)
        refuse("groups of the IGES file are nested deeper than %d levels, or in a circle", MAX_DEPTH);
    auto known = t->made.find(what.from.get());
    if (known != t->made.end())
        return known->second;
    iges_item inner = without_wrappings(*t, { what.from, what.shape.Located(TopLoc_Location()) });
    TDF_Label label = is_group(inner.from) ? add_group(t, inner, depth) : add_whole(*t, inner.shape);
    describe(*t, label, inner.from);
    if (inner.from != what.from)
        describe(*t, label, what.from);
    t->made[what.from.get()] = label;
    return label;
}

/* Adds a root entity of the file to the document. XCAF roots have no placement, so a root with a placement is wrapped in an assembly. */
void add_root(iges_tree *t, const iges_item &root)
{
    if (product_of(root.from) == root.from && root.shape.Location().IsIdentity()) {
        label_of(t, root, 0);
        return;
    }
    TDF_Label holder = t->shapes->NewShape();
    TDataStd_Name::Set(holder, TCollection_ExtendedString());
    add_component(t, holder, root, 1);
}

} // namespace

void iges_tree_add(IGESControl_Reader &iges, const Handle(TDocStd_Document) & document, const struct text_encoding &encoding)
{
    iges_tree t;
    std::vector<iges_item> loose;
    Handle(IGESData_IGESModel) model = Handle(IGESData_IGESModel)::DownCast(iges.WS()->Model());
    t.shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    t.colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
    t.layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
    t.encoding = &encoding;
    t.process = iges.WS()->TransferReader()->TransientProcess();
    t.unit_mm = model->GlobalSection().UnitValue();
    for (int i = 1; i <= iges.NbRootsForTransfer(); i++) {
        iges_item root = { entity::DownCast(iges.RootForTransfer(i)), TopoDS_Shape() };
        if (!root.from.IsNull() && iges.TransferOneRoot(i))
            root.shape = iges.Shape(iges.NbShapes());
        switch (kind_of(root)) {
        case shape_kind::part: add_root(&t, root); break;
        case shape_kind::surface: loose.push_back(root); break;
        case shape_kind::nothing: break;
        }
    }
    for (const auto &entry : by_layer(loose)) {
        TDF_Label part = add_surfaces(t, entry.second);
        std::string name = entry.first.empty() ? "Surfaces" : "Layer " + encoding.utf8(entry.first);
        TDataStd_Name::Set(part, TCollection_ExtendedString(name.c_str(), Standard_True));
        describe_layer(t, part, entry.first);
    }
    t.shapes->UpdateAssemblies();
}

std::string iges_units(IGESControl_Reader &iges)
{
    Handle(IGESData_IGESModel) model = Handle(IGESData_IGESModel)::DownCast(iges.WS()->Model());
    static const char *const names[] = { "",      "inch",      "millimetre",       "",           "foot",       "mile",
                                         "metre", "kilometre", "mil (0.001 inch)", "micrometre", "centimetre", "microinch" };
    int flag = model.IsNull() ? 0 : model->GlobalSection().UnitFlag();
    return flag > 0 && flag < static_cast<int>(sizeof(names) / sizeof(names[0])) ? names[flag] : "";
}
