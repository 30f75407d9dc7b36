/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds faces that Open CASCADE could not read, and counts them per body. Each body is reported with its product's name. */
#include "preprocess/import/readers/occt_losses.hh"
#include "preprocess/import/readers/reader.hh"

#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESGeom_BoundedSurface.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSolid_Face.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_InterfaceModel.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationRelationship.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

namespace
{

using entity = Handle(Standard_Transient);

constexpr size_t MOST_KINDS = 100; /* maximum number of different errors printed per file */
constexpr size_t MOST_IDS = 5;     /* maximum number of entity ids printed in one line */
constexpr size_t MOST_VISITED = 10000;

struct file_losses {
    Handle(Interface_InterfaceModel) model;
    Handle(Transfer_TransientProcess) process;
    const std::string &file;
};

/* --- errors ------------------------------------------------------------------------------------------------------------------------- */

/* Returns an Open CASCADE error text without parameter indices ("n0.12 "), so that errors that differ only in the index are
 * counted together. */
std::string without_number(const std::string &text)
{
    size_t from = text.find("n0."), end = from == std::string::npos ? from : text.find_first_not_of("0123456789", from + 3);
    return end == std::string::npos ? text : text.substr(0, from) + text.substr(end + (text[end] == ' '));
}

/* Returns whether another part of the reader already reports or repairs this error: step_files.hh reports missing files, and
 * iges_tree.cc builds scaled instances of subfigures. */
bool is_dealt_with(const entity &from, const std::string &text)
{
    Handle(IGESBasic_SingularSubfigure) place = Handle(IGESBasic_SingularSubfigure)::DownCast(from);
    return text.find("Can not read external file") != std::string::npos || (!place.IsNull() && place->HasScaleFactor());
}

/* Returns the entity's id in the file: "#12" in STEP, "D12" in IGES. */
std::string id_of(const file_losses &of, const entity &from)
{
    return of.model->StringLabel(from)->ToCString();
}

/* Returns the entity's Open CASCADE type without package prefix, such as "AdvancedFace". */
std::string type_of(const entity &from)
{
    std::string name = from->DynamicType()->Name();
    return name.substr(name.find('_') == std::string::npos ? 0 : name.find('_') + 1);
}

struct error_kind {
    size_t count = 0;
    std::string ids;
};

void add_errors(const file_losses &of, const entity &from, const Handle(Interface_Check) & check, std::map<std::string, error_kind> *to)
{
    for (int i = 1; !check.IsNull() && i <= check->NbFails(); i++) {
        if (is_dealt_with(from, check->CFail(i)))
            continue;
        error_kind &kind = (*to)[type_of(from) + ": " + without_number(one_line(check->CFail(i)))];
        if (kind.count++ < MOST_IDS)
            kind.ids += " " + id_of(of, from);
    }
}

void say_errors(const file_losses &of)
{
    std::map<std::string, error_kind> kinds;
    size_t printed = 0;
    for (int i = 1; i <= of.model->NbEntities(); i++)
        add_errors(of, of.model->Value(i), of.model->Check(i, Standard_True), &kinds);
    for (int i = 1; i <= of.process->NbMapped(); i++)
        if (!of.process->MapItem(i).IsNull() && of.model->Contains(of.process->Mapped(i)))
            add_errors(of, of.process->Mapped(i), of.process->MapItem(i)->Check(), &kinds);
    for (const auto &[text, kind] : kinds)
        if (printed++ < MOST_KINDS)
            printf("error\t%zu\tOpen CASCADE: %s%s%s%s\n", kind.count, of.file.c_str(), text.c_str(), kind.ids.c_str(),
                   kind.count > MOST_IDS ? " ..." : "");
    if (printed > MOST_KINDS)
        printf("error\t%zu\tOpen CASCADE: %sfurther kinds of errors in the file, which are not listed\n", printed - MOST_KINDS,
               of.file.c_str());
}

/* --- faces -------------------------------------------------------------------------------------------------------------------------- */

bool is_face(const entity &from)
{
    return from->IsKind(STANDARD_TYPE(StepShape_FaceSurface)) || from->IsKind(STANDARD_TYPE(IGESSolid_Face)) ||
           from->IsKind(STANDARD_TYPE(IGESGeom_TrimmedSurface)) || from->IsKind(STANDARD_TYPE(IGESGeom_BoundedSurface));
}

bool is_body(const entity &from)
{
    return from->IsKind(STANDARD_TYPE(StepShape_SolidModel)) || from->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel)) ||
           from->IsKind(STANDARD_TYPE(StepShape_FaceBasedSurfaceModel));
}

bool has_shape(const file_losses &of, const entity &from)
{
    Handle(Transfer_Binder) binder = of.process->Find(from);
    return !binder.IsNull() && !TransferBRep::ShapeResult(binder).IsNull();
}

std::string product_name(const entity &from)
{
    Handle(StepShape_ShapeDefinitionRepresentation) shown = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(from);
    Handle(StepRepr_PropertyDefinition) property = shown.IsNull() ? nullptr : shown->Definition().PropertyDefinition();
    Handle(StepBasic_ProductDefinition) definition = property.IsNull() ? nullptr : property->Definition().ProductDefinition();
    if (definition.IsNull() || definition->Formation().IsNull() || definition->Formation()->OfProduct().IsNull())
        return "";
    Handle(StepBasic_Product) product = definition->Formation()->OfProduct();
    Handle(TCollection_HAsciiString) name = product->Name().IsNull() || product->Name()->IsEmpty() ? product->Id() : product->Name();
    return name.IsNull() ? "" : one_line(name->ToCString());
}

/* body: the body that contains the face, or the face itself if no body does; name: name of the product that contains the body */
struct face_owner {
    entity body;
    std::string name;
};

/* Finds the body and the product that contain a face: follows references backwards, breadth first, up to the first product. */
face_owner owner_of(const Interface_Graph &graph, const entity &face)
{
    face_owner out = { face, "" };
    std::vector<entity> open = { face };
    std::set<const Standard_Transient *> seen = { face.get() };
    for (size_t at = 0; at < open.size() && at < MOST_VISITED && out.name.empty(); at++) {
        const entity from = open[at];
        std::vector<entity> next;
        if (is_body(from) && out.body == face)
            out.body = from;
        out.name = product_name(from);
        for (Interface_EntityIterator by = graph.Sharings(from); by.More(); by.Next())
            next.push_back(by.Value());
        Handle(StepRepr_RepresentationRelationship) same = Handle(StepRepr_RepresentationRelationship)::DownCast(from);
        if (!same.IsNull()) {
            next.push_back(same->Rep1());
            next.push_back(same->Rep2());
        }
        for (const entity &each : next)
            if (!each.IsNull() && seen.insert(each.get()).second)
                open.push_back(each);
    }
    Handle(IGESData_IGESEntity) iges = Handle(IGESData_IGESEntity)::DownCast(out.body);
    if (!iges.IsNull() && iges->HasName() && !iges->NameValue().IsNull())
        out.name = one_line(iges->NameValue()->ToCString());
    return out;
}

struct lost_faces {
    face_owner owner;
    std::vector<entity> faces;
};

void say_lost(const file_losses &of, const lost_faces &lost)
{
    std::string ids;
    for (size_t i = 0; i < lost.faces.size() && i < MOST_IDS; i++)
        ids += " " + id_of(of, lost.faces[i]);
    const std::string more = lost.faces.size() > MOST_IDS ? " ..." : "";
    const std::string reason = lost.owner.body == lost.faces[0]
                                   ? "Open CASCADE could not read this shape, which is left out"
                                   : std::to_string(lost.faces.size()) + " faces of this shape could not be read, and are left out:" +
                                         ids + more;
    printf("lost\t%s\t%s%s\t%s\t\t%s\n", id_of(of, lost.owner.body).c_str(), of.file.c_str(), lost.owner.name.c_str(),
           type_of(lost.owner.body).c_str(), reason.c_str());
}

void say_lost_faces(const file_losses &of, const Interface_Graph &graph)
{
    std::map<int, lost_faces> bodies; /* counts of lost faces, by index of the body's entity in the model */
    for (int i = 1; i <= of.model->NbEntities(); i++) {
        const entity face = of.model->Value(i);
        if (!is_face(face) || has_shape(of, face))
            continue;
        face_owner owner = owner_of(graph, face);
        lost_faces &body = bodies[of.model->Number(owner.body)];
        body.owner = owner;
        body.faces.push_back(face);
    }
    for (const auto &entry : bodies)
        say_lost(of, entry.second);
}

/* Prints a line of the reader's output about missing instances of a product that itself was read. */
void say_lost_places(const file_losses &of)
{
    for (int i = 1; i <= of.model->NbEntities(); i++) {
        Handle(StepRepr_NextAssemblyUsageOccurrence) place = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(of.model->Value(i));
        Handle(StepBasic_ProductDefinition) product = place.IsNull() ? nullptr : place->RelatedProductDefinition();
        if (product.IsNull() || has_shape(of, place) || !has_shape(of, product))
            continue;
        Handle(TCollection_HAsciiString) name = place->Name().IsNull() || place->Name()->IsEmpty() ? place->Id() : place->Name();
        printf("lost\t%s\t%s%s\tplace\t\tthe part is left out here: the file gives no placement, or an unsupported kind of one\n",
               id_of(of, place).c_str(), of.file.c_str(), name.IsNull() ? "" : one_line(name->ToCString()).c_str());
    }
}

} // namespace

void occt_losses_say(const Handle(XSControl_WorkSession) & session, const std::string &file)
{
    if (session->Model()->NbEntities() == 0)
        return;
    const file_losses of = { session->Model(), session->TransferReader()->TransientProcess(), file };
    say_errors(of);
    say_lost_faces(of, session->Graph());
    say_lost_places(of);
}
